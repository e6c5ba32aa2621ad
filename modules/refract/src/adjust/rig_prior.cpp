// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* C = D R D with the standard deviations D and the correlations R = U L U^T:  W = L^-1/2 U^T D^-1. The parameters' sizes differ
by orders, the correlations do not. */

#include "adjust/rig_prior.hpp"
#include "math/dense.hpp"

namespace cv { namespace refract {

/* A file has the covariance with finite digits: of the correlations' eigenvalues, what is below this part of 1 is rounding; so is
what is as large as the lowest is negative. */
static const double ROUNDING = 1e-10;

//! L^-1/2 U^T of correlations U L U^T.
static Eigen::MatrixXd inverseRoot(const Eigen::MatrixXd& correlations)
{
    const SymmetricEigen eigen(correlations);
    const double rounding = std::max(ROUNDING*eigen.values.maxCoeff(), -eigen.values.minCoeff());
    const Eigen::VectorXd roots = eigen.values.cwiseMax(rounding).cwiseSqrt().cwiseInverse();
    return roots.asDiagonal()*eigen.vectors.transpose();
}

Eigen::MatrixXd whiten(const Eigen::MatrixXd& C, const Eigen::MatrixXd& B)
{
    const LLT root(C);
    const Eigen::VectorXd inverse = C.diagonal().cwiseSqrt().cwiseInverse();
    if (root.isPositiveDefinite() && root.L().diagonal().cwiseProduct(inverse).minCoeff() > std::sqrt(ROUNDING))
        return root.solveL(B);
    return product(inverseRoot(inverse.asDiagonal()*C*inverse.asDiagonal())*inverse.asDiagonal(), B);
}

RigPrior makeRigPrior(const Eigen::VectorXd& mean, const Eigen::MatrixXd& directions, const Eigen::MatrixXd& covariance)
{
    RigPrior prior;
    prior.mean = mean;
    prior.sqrtInformation.resize(0, mean.size());
    if (covariance.rows() == 0)
        return prior;
    const Eigen::VectorXd inverse = covariance.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd symmetric = 0.5*(covariance + covariance.transpose());
    const Eigen::MatrixXd root = inverseRoot(inverse.asDiagonal()*symmetric*inverse.asDiagonal());
    prior.sqrtInformation = timesTranspose(root*inverse.asDiagonal(), directions);
    return prior;
}

}} // namespace
