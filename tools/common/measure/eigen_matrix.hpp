// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_EIGEN_MATRIX_HPP
#define REFRACT_TOOLS_EIGEN_MATRIX_HPP

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace tools {

using Eigen::MatrixXd;
using Eigen::VectorXd;

//! The same numbers.
MatrixXd toEigen(const cv::Mat& matrix);
cv::Mat toMat(const MatrixXd& matrix);

struct VectorLength
{
    double value, std;
};

/** The length of a small vector that is an estimate: a tilt, a wedge, a move. Where one axis is known much worse than another, no length
tells that; say the components too. Of one number: that number with its sign. */
VectorLength lengthOf(const VectorXd& estimate, const MatrixXd& covariance);

} // namespace tools

#endif // REFRACT_TOOLS_EIGEN_MATRIX_HPP
