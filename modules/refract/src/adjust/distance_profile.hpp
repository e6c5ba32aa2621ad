// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_DISTANCE_PROFILE_HPP
#define OPENCV_REFRACT_DISTANCE_PROFILE_HPP

#include "adjust/eliminate.hpp"

namespace cv { namespace refract {

/** Widens a covariance where the likelihood's profile of a free distance, or of the centre of a dome, is wider than its derivatives at
the least squares say.
@param problem at its least squares; stays there
@param information of all that is free
@param variance of a pixel coordinate
@param half H, H H^T = covariance of the outer parameters for unit pixel noise
@return whether it was widened */
bool widenByProfiles(Problem& problem, const Information& information, double variance, Eigen::MatrixXd& half);

}} // namespace

#endif // OPENCV_REFRACT_DISTANCE_PROFILE_HPP
