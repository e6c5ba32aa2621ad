// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CENTRAL_CAMERA_HPP
#define REFRACT_TOOLS_CENTRAL_CAMERA_HPP

#include "calibrate/rigid_transform.hpp"
#include <opencv2/refract.hpp>
#include <string>
#include <vector>

namespace tools {

/* The central camera (without a window) that best approximates a camera behind a window, between two depths: its lens and pose are
fitted to exact projections of points all over the image and the range. Its centre is not that of the true camera: a pane in air
shifts the apparent centre of projection, a port in water also changes the focal length. The error that remains is reported. */

//! Errors of the central camera's projections over the whole range.
struct CentralError
{
    double rms = 0, max = 0;                //!< px
    double lengthRms = 0, lengthMax = 0;    //!< in the plane of a point that is parallel to the image, unit of the rig
};

struct CentralCamera
{
    cv::Ptr<cv::refract::RefractiveCamera> camera;  //!< without a window
    RigidTransform pose;                            //!< frame of the true camera -> this one
    CentralError error;
};

/** @param camera with its image size
@param range z in the frame of the camera, near and far, both finite
@param coefficients of OpenCV's model; 0: those of cv::fisheye
@param name of the camera, for a sentence */
CentralCamera fitCentralCamera(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const cv::Vec2d& range, int coefficients,
                               const std::string& name);

//! A camera without a window is its own central camera. @param camera with its image size
CentralCamera centralCamera(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const cv::Vec2d& range);

} // namespace tools

#endif // REFRACT_TOOLS_CENTRAL_CAMERA_HPP
