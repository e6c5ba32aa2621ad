// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_EIGEN_MATRIX_HPP
#define REFRACT_TOOLS_EIGEN_MATRIX_HPP

#include <opencv2/core.hpp>
#include <Eigen/Core>

namespace tools {

using Eigen::MatrixXd;
using Eigen::VectorXd;

//! The same numbers.
MatrixXd toEigen(const cv::Mat& matrix);
cv::Mat toMat(const MatrixXd& matrix);

} // namespace tools

#endif // REFRACT_TOOLS_EIGEN_MATRIX_HPP
