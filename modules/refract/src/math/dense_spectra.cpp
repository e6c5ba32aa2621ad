// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/dense.hpp"
#include <Eigen/Eigenvalues>

namespace cv { namespace refract {

using Eigen::MatrixXd;
using Eigen::VectorXd;

SymmetricEigen::SymmetricEigen(const MatrixRef& A)
{
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(A);
    values = eigen.eigenvalues();
    vectors = eigen.eigenvectors();
}

CorrelationSpectrum::CorrelationSpectrum(const MatrixRef& C) : deviations(C.diagonal().cwiseMax(0.).cwiseSqrt())
{
    inverseDeviations = deviations.unaryExpr([](double d) { return d > 0 ? 1/d : 0.; });
    SymmetricEigen eigen(inverseDeviations.asDiagonal()*C*inverseDeviations.asDiagonal());
    values = std::move(eigen.values);
    vectors = std::move(eigen.vectors);
}

int CorrelationSpectrum::rank(double nothing) const { return (int)(values.array() > nothing*values.cwiseMax(0.).sum()).count(); }

MatrixXd CorrelationSpectrum::root(int rank) const
{
    return deviations.asDiagonal()*vectors.rightCols(rank)*values.tail(rank).cwiseSqrt().asDiagonal();
}

MatrixXd CorrelationSpectrum::inverseRoot(int rank) const
{
    return inverseDeviations.asDiagonal()*vectors.rightCols(rank)*values.tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
}

SymmetricEigen3::SymmetricEigen3(const Eigen::Matrix3d& A)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(A);
    values = eigen.eigenvalues();
    vectors = eigen.eigenvectors();
}

}} // namespace
