// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/eigen_matrix.hpp"

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

} // namespace tools
