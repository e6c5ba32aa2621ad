// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_POSES_HPP
#define OPENCV_REFRACT_POSES_HPP

#include "camera.hpp"

namespace cv { namespace refract {

//! Object -> camera.
struct Pose
{
    Vec3d rvec, tvec;
    bool found = false;
};

/** Pose of a target seen through lens and window: closed-form start on the bearings (solvePnP on the pinhole directions),
then maximum likelihood. NaN image points are left out.
@param start if found, the start
@param rms reprojection error in pixels by cv::calibrateCamera's definition */
Pose solvePose(const Camera& camera, const std::vector<Point3d>& objectPoints, const std::vector<Point2d>& imagePoints,
               const Pose& start, double& rms);

}} // namespace

#endif // OPENCV_REFRACT_POSES_HPP
