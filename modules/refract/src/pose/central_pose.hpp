// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CENTRAL_POSE_HPP
#define OPENCV_REFRACT_CENTRAL_POSE_HPP

#include "camera/camera.hpp"
#include "math/rigid_transform.hpp"

/* Where a search for two cameras' pose begins. About their mean origins the rays are nearly central: OpenCV's methods for pinholes
on the bearings, with limits from the caller's to many times that, give R and the baseline. */

namespace cv { namespace refract {

//! A camera as a pinhole at its rays' mean origin.
struct Bearings
{
    Matx33d turn = Matx33d::eye();          //!< camera -> pinhole, which looks along the mean ray
    Vec3d centre;                           //!< of the pinhole, in the camera
    std::vector<Point2d> normalized;        //!< NaN where there is no ray in front
};

Bearings bearingsOf(const Camera& camera, const std::vector<Point2d>& pixels);

/** Poses of length 1. Matches on a plane agree with two of them, which both are here.
@param threshold least limit, of normalised coordinates
@param prob chance of a sample without wrong matches */
std::vector<RigidTransform> centralPoses(const Bearings& b1, const Bearings& b2, double threshold, double prob);

}} // namespace

#endif // OPENCV_REFRACT_CENTRAL_POSE_HPP
