// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/dense.hpp"
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace cv { namespace refract {

using Eigen::MatrixXd;
using Eigen::VectorXd;

SymmetricEigen::SymmetricEigen(const MatrixRef& A)
{
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(A);
    values = eigen.eigenvalues();
    vectors = eigen.eigenvectors();
}

SymmetricEigen3::SymmetricEigen3(const Eigen::Matrix3d& A)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(A);
    values = eigen.eigenvalues();
    vectors = eigen.eigenvectors();
}

SingularValues::SingularValues(const MatrixRef& A)
{
    const Eigen::JacobiSVD<MatrixXd> svd(A, Eigen::ComputeFullV);
    values = svd.singularValues();
    V = svd.matrixV();
}

}} // namespace
