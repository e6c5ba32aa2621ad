#ifndef REFRACT_TOOLS_EIGEN_MATRIX_HPP
#define REFRACT_TOOLS_EIGEN_MATRIX_HPP

#include <opencv2/core.hpp>
#include <Eigen/Core>

namespace tools {

//! The same numbers.
Eigen::MatrixXd toEigen(const cv::Mat& matrix);
cv::Mat toMat(const Eigen::MatrixXd& matrix);

} // namespace tools

#endif // REFRACT_TOOLS_EIGEN_MATRIX_HPP
