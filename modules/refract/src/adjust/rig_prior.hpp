// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_PRIOR_HPP
#define OPENCV_REFRACT_RIG_PRIOR_HPP

#include <Eigen/Core>

namespace cv { namespace refract {

/** What an earlier calibration knows of all cameras together: x ~ N(mean, C). W (x - mean) has unit covariance, with as many rows
as there are independent directions. A coordinate that C does not know has the column 0. */
struct RigPrior
{
    Eigen::VectorXd mean;
    Eigen::MatrixXd sqrtInformation;        //!< W; no rows: nothing is known

    int count() const { return (int)sqrtInformation.rows(); }
};

/** W B with W^T W = C^-1: B = 1 whitens what is known with the covariance C, of positive variances. A combination that C knows far
better than its correlations tell is taken to be known as well as these. */
Eigen::MatrixXd whiten(const Eigen::MatrixXd& C, const Eigen::MatrixXd& B);

/** @param directions N x K, orthonormal: those that are known (of a normal its two tangents)
@param covariance K x K along them, as whiten() takes it */
RigPrior makeRigPrior(const Eigen::VectorXd& mean, const Eigen::MatrixXd& directions, const Eigen::MatrixXd& covariance);

}} // namespace

#endif // OPENCV_REFRACT_RIG_PRIOR_HPP
