// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LENGTH_PROFILE_HPP
#define OPENCV_REFRACT_LENGTH_PROFILE_HPP

#include "pose/relative_pose.hpp"

/* The length of T by the likelihood's profile: at each length the least sum of squares that R and the direction of T allow. Far
out refraction fades and the profile becomes flat, so that lengths may be known from one side only. */

namespace cv { namespace refract {

//! Lengths of T at which refraction may tell something, each twice the one before; 1 where no window refracts.
std::vector<double> lengthsToTry(const MatchedCameras& pair);

//! The most likely pose of those at lengthsToTry, each found from its neighbour's.
RigidTransform mostLikelyLength(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& start);

//! What the interval of a length takes besides the matches.
struct LengthEvidence
{
    RigidTransform pose;        //!< the most likely one
    double cost;                //!< its sum of squared errors
    double freedom;             //!< degrees of freedom of these
    Matx33d covariance;         //!< of T
};

//! Which lengths T may have, and the most likely poses at the shortest and the longest.
struct LengthInterval
{
    Vec2d lengths;              //!< 0 and infinity: no shorter, no longer one can be ruled out
    RigidTransform ends[2];
};

/** Lengths that hold the truth with 95 %: those whose least sum of squares is above the least of all by no more than it is, in 95 % of all
cases, where this length is the true one.

Were the length a parameter as any other, the excess would be Student's t squared. But all T of one length are a sphere. Where its
radius is not large against the errors of T, the sphere bends within them, and the excess at the truth is that of up to three
parameters. It is simulated, with normally distributed errors of the given covariance. */
LengthInterval lengthInterval(const MatchedCameras& pair, const PixelMatches& matches, const LengthEvidence& evidence);

}} // namespace

#endif // OPENCV_REFRACT_LENGTH_PROFILE_HPP
