// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/dense.hpp"
#include <Eigen/SVD>

namespace cv { namespace refract {

using Eigen::MatrixXd;

SingularValues::SingularValues(const MatrixRef& A)
{
    const Eigen::JacobiSVD<MatrixXd> svd(A, Eigen::ComputeFullV);
    values = svd.singularValues();
    V = svd.matrixV();
}

}} // namespace
