// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RELATIVE_ESTIMATE_HPP
#define OPENCV_REFRACT_RELATIVE_ESTIMATE_HPP

#include "pose/relative_pose.hpp"
#include <numeric>

/* The most likely relative pose near one that is nearly right, and what it is worth. The scale shows only in how the rays miss the
pinholes; what is known of it is the likelihood's profile (length_profile.hpp). */

namespace cv { namespace refract {

//! What is estimated, and its worth.
struct RelativeEstimate
{
    RigidTransform motion;
    Matx66d covariance;
    Vec2d interval;
    RigidTransform likely;              //!< of all lengths, though the most likely one be infinite
    Matx66d ofNoise;                    //!< covariance of that, all lengths
    std::vector<int> fitted, inliers;
    double variance;                    //!< of an error
    std::vector<double> squares;        //!< errors of all matches, squared, cut off at the limit
    double cost() const { return std::accumulate(squares.begin(), squares.end(), 0.); }
};

//! The most likely pose over all lengths, from a good one; false if there are too few inliers.
bool estimateRelativePose(const MatchedCameras& pair, const PixelMatches& matches, double limit, const RigidTransform& start,
                          RelativeEstimate& e);

/** Whether another estimate, and none of those that the covariance speaks of, is as likely. Which of two poses of a plane is right
shows in no single match: each is off both by noise alone, in directions of its own. So the costs differ by the sum of as many
random numbers, and by more only if one of the poses is wrong (@cite Vuong1989); if both agree with nearly as many matches, as
what was cut off is no noise. The covariance may be that at one length, at which both are compared. */
bool isAmbiguous(const MatchedCameras& pair, const PixelMatches& matches, const RelativeEstimate& e, const RelativeEstimate& other);

/** Adds what inexact cameras do to the pose, and makes the interval of its length longer: by as much, in the logarithm, as the
length's standard deviation grows. */
void addCameras(const Camera& camera1, const Camera& camera2, const MatchedPixels& pixels, const Mat (&covariances)[2],
                RelativeEstimate& e);

}} // namespace

#endif // OPENCV_REFRACT_RELATIVE_ESTIMATE_HPP
