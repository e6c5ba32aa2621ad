// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/eigen_matrix.hpp"
#include "math/dense.hpp"
#include <algorithm>
#include <cmath>

using cv::Mat;

namespace tools {

MatrixXd toEigen(const Mat& matrix)
{
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Mat whole = matrix.isContinuous() ? matrix : matrix.clone();
    return Eigen::Map<const RowMajor>(whole.ptr<double>(), whole.rows, whole.cols);
}

Mat toMat(const MatrixXd& matrix)
{
    Mat result((int)matrix.rows(), (int)matrix.cols(), CV_64F);
    for (int r = 0; r < result.rows; r++)
        for (int c = 0; c < result.cols; c++)
            result.at<double>(r, c) = matrix(r, c);
    return result;
}

VectorLength lengthOf(const VectorXd& estimate, const MatrixXd& covariance)
{
    if (estimate.size() == 1)
        return {estimate[0], std::sqrt(std::max(0., covariance(0, 0)))};
    const double length = estimate.norm(), trace = covariance.trace();
    const VectorXd along = length > 0. ? VectorXd(estimate/length) : VectorXd(VectorXd::Zero(estimate.size()));
    const double variance = std::max(0., along.dot(cv::refract::timesVector(covariance, along))), across = std::max(0., trace - variance);
    // Errors across it make a vector longer, whatever they are: by as much its length is in doubt.
    return {length, std::hypot(std::sqrt(variance), std::hypot(length, std::sqrt(across)) - length)};
}

} // namespace tools
