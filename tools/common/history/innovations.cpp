// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "history/innovations.hpp"
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace tools {

namespace {

const double NOTHING = 1e-9;        // of the largest eigenvalue of a correlation

//! root and inverse of V, whose rows are of all sizes.
void decompose(const MatrixXd& V, Innovation& innovation)
{
    const VectorXd std = V.diagonal().cwiseMax(0.).cwiseSqrt();
    const VectorXd scale = std.unaryExpr([](double s) { return s > 0. ? 1./s : 0.; });
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal()*V*scale.asDiagonal());
    const VectorXd& values = eigen.eigenvalues();
    const Eigen::Index rank = (values.array() > NOTHING*values.cwiseMax(0.).sum()).count();
    const MatrixXd vectors = eigen.eigenvectors().rightCols(rank);
    innovation.root = std.asDiagonal()*vectors*values.tail(rank).cwiseSqrt().asDiagonal();
    const MatrixXd inverseRoot = scale.asDiagonal()*vectors*values.tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
    innovation.inverse = inverseRoot*inverseRoot.transpose();
}

//! Block by block the inverse of the information: from a score to the estimates of changes, each by itself.
MatrixXd estimatesOfScore(const CheckRecord& check, const std::vector<ChartedChange>& changes)
{
    MatrixXd M = MatrixXd::Zero(check.score.size(), check.score.size());
    Eigen::Index first = 0;
    for (int c : check.changes)
    {
        const int size = changes[c].size();
        M.block(first, first, size, size) = check.information.block(first, first, size, size).inverse();
        first += size;
    }
    return M;
}

} // namespace

InnovationFilter::InnovationFilter(const MatrixXd& covariance, Eigen::Index scenarios)
    : C0_(covariance), C_(covariance), mean_(MatrixXd::Zero(covariance.rows(), scenarios))
{
}

Innovation InnovationFilter::add(const CheckRecord& check, const std::vector<ChartedChange>& changes, const MatrixXd& scores)
{
    const MatrixXd& D = check.byParameters;
    Innovation result;
    decompose(check.information - D*(C0_ - C_)*D.transpose(), result);
    result.value = scores - D*mean_;
    const MatrixXd gain = C_*D.transpose()*result.inverse;
    mean_ += gain*result.value;
    C_ -= gain*D*C_;
    C_ = 0.5*(C_ + C_.transpose()).eval();
    const MatrixXd M = estimatesOfScore(check, changes);
    result.alone = M*result.value;
    result.rootAlone = M*result.root;
    result.stdAlone = result.rootAlone.rowwise().norm();
    return result;
}

} // namespace tools
