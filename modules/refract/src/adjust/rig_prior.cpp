// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/rig_prior.hpp"
#include "math/dense.hpp"

namespace cv { namespace refract {

/* A file has the covariance with finite digits: of the correlations' eigenvalues, what is below this part of 1 is rounding; so is
what is as large as the lowest is negative. */
static const double ROUNDING = 1e-10;

//! W, W^T W = C^-1.
static Eigen::MatrixXd inverseRoot(const Eigen::MatrixXd& C)
{
    const CorrelationSpectrum spectrum(C);
    const double rounding = std::max(ROUNDING*spectrum.values.maxCoeff(), -spectrum.values.minCoeff());
    const Eigen::VectorXd roots = spectrum.values.cwiseMax(rounding).cwiseSqrt().cwiseInverse();
    return roots.asDiagonal()*spectrum.vectors.transpose()*spectrum.inverseDeviations.asDiagonal();
}

Eigen::MatrixXd whiten(const Eigen::MatrixXd& C, const Eigen::MatrixXd& B)
{
    const LLT root(C);
    const Eigen::VectorXd inverse = C.diagonal().cwiseSqrt().cwiseInverse();
    if (root.isPositiveDefinite() && root.L().diagonal().cwiseProduct(inverse).minCoeff() > std::sqrt(ROUNDING))
        return root.solveL(B);
    return product(inverseRoot(C), B);
}

RigPrior makeRigPrior(const Eigen::VectorXd& mean, const Eigen::MatrixXd& directions, const Eigen::MatrixXd& covariance)
{
    RigPrior prior;
    prior.mean = mean;
    prior.sqrtInformation.resize(0, mean.size());
    if (covariance.rows() == 0)
        return prior;
    prior.sqrtInformation = timesTranspose(inverseRoot(0.5*(covariance + covariance.transpose())), directions);
    return prior;
}

}} // namespace
