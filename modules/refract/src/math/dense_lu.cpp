// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/dense.hpp"
#include <Eigen/LU>

namespace cv { namespace refract {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd inverse(const MatrixRef& A) { return A.inverse(); }
Eigen::Matrix2d inverse2(const Eigen::Matrix2d& A) { return A.inverse(); }
Eigen::Matrix3d inverse3(const Eigen::Matrix3d& A) { return A.inverse(); }

}} // namespace
