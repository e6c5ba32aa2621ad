// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* C = D R D with the standard deviations D and the correlations R = U L U^T:  W = L^-1/2 U^T D^-1. The parameters' sizes differ
by orders, the correlations do not. */

#include "adjust/rig_prior.hpp"
#include "math/dense.hpp"
#include <opencv2/core.hpp>

namespace cv { namespace refract {

// A file has the covariance with finite digits: of the correlations' eigenvalues, what is below this part of 1 is rounding.
static const double ROUNDING = 1e-10;

RigPrior makeRigPrior(const Eigen::VectorXd& mean, const Eigen::MatrixXd& directions, const Eigen::MatrixXd& covariance)
{
    RigPrior prior;
    prior.mean = mean;
    prior.sqrtInformation.resize(0, mean.size());
    if (covariance.rows() == 0)
        return prior;
    const Eigen::VectorXd inverse = covariance.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd symmetric = 0.5*(covariance + covariance.transpose());
    const SymmetricEigen eigen(inverse.asDiagonal()*symmetric*inverse.asDiagonal());
    const double most = eigen.values.maxCoeff();
    if (!(eigen.values[0] > -std::sqrt(ROUNDING)*most))
        CV_Error_(Error::StsBadArg, ("rigCovariance is no covariance: a combination of its parameters has a variance below 0 (%g of "
                                     "the largest)", eigen.values[0]/most));
    const Eigen::VectorXd roots = eigen.values.cwiseMax(ROUNDING*most).cwiseSqrt().cwiseInverse();
    prior.sqrtInformation = timesTranspose(roots.asDiagonal()*eigen.vectors.transpose()*inverse.asDiagonal(), directions);
    return prior;
}

}} // namespace
