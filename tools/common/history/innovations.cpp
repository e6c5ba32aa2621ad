// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "history/innovations.hpp"
#include "math/dense.hpp"

using namespace cv::refract;

namespace tools {

namespace {

const double NOTHING = 1e-9;        // of the largest eigenvalue of a correlation

void decompose(const MatrixXd& V, Innovation& innovation)
{
    const CorrelationSpectrum spectrum(V);
    const int rank = spectrum.rank(NOTHING);
    innovation.root = spectrum.root(rank);
    const MatrixXd inverseRoot = spectrum.inverseRoot(rank);
    innovation.inverse = timesTranspose(inverseRoot, inverseRoot);
}

//! Block by block the inverse of the information: from a score to the estimates of changes, each by itself.
MatrixXd estimatesOfScore(const CheckRecord& check, const std::vector<ChartedChange>& changes)
{
    MatrixXd M = MatrixXd::Zero(check.score.size(), check.score.size());
    Eigen::Index first = 0;
    for (int c : check.changes)
    {
        const int size = changes[c].size();
        M.block(first, first, size, size) = inverse(check.information.block(first, first, size, size));
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
    decompose(check.information - timesTranspose(product(D, C0_ - C_), D), result);
    result.value = scores - product(D, mean_);
    const MatrixXd gain = product(timesTranspose(C_, D), result.inverse);
    mean_ += product(gain, result.value);
    C_ -= product(product(gain, D), C_);
    C_ = 0.5*(C_ + C_.transpose()).eval();
    const MatrixXd M = estimatesOfScore(check, changes);
    result.alone = product(M, result.value);
    result.rootAlone = product(M, result.root);
    result.stdAlone = result.rootAlone.rowwise().norm();
    return result;
}

} // namespace tools
