// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CENTRAL_CAMERA_HPP
#define REFRACT_TOOLS_CENTRAL_CAMERA_HPP

#include "calibrate/rigid_transform.hpp"
#include <opencv2/refract.hpp>
#include <string>
#include <vector>

namespace tools {

//! Scene points, camera frame, and their pixels: central cameras are fitted to them and compared with them.
struct SeenPoints
{
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    bool allBeyondWindow = true;        //!< hardly a pixel meets one of the depths within its window
};

//! Pixels all over the image, seen at depths whose inverses are evenly spaced.
SeenPoints seenPoints(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const cv::Vec2d& range, int columns, int rows, int depths);

//! Throws Failure if the camera of that name sees hardly anything of the range.
void requireEnough(const SeenPoints& seen, const cv::Vec2d& range, const std::string& name);

/* The central camera (without a window) that best approximates a camera behind a window, between two depths: its lens and pose are
fitted to exact projections of points all over the image and the range. Its centre is not that of the true camera: a pane in air
shifts the apparent centre of projection, a port in water also changes the focal length. The error that remains is reported. */

//! Errors of the central camera's projections over the whole range.
struct CentralError
{
    double rms = 0, max = 0;                //!< px
    double lengthRms = 0, lengthMax = 0;    //!< of points from their pixels' rays, within twice the far end; unit of the rig
};

struct CentralCamera
{
    cv::Ptr<cv::refract::RefractiveCamera> camera;  //!< without a window
    RigidTransform pose;                            //!< frame of the true camera -> this one
    CentralError error;
};

CentralError errorOf(const SeenPoints& seen, const cv::Vec2d& range, const CentralCamera& central);

/** Its error is NaN, or larger than the image, where the lens model cannot do it.
@param camera with its image size
@param range z in the frame of the camera, near and far, both finite
@param coefficients of OpenCV's model; 0: those of cv::fisheye
@param name of the camera, for a sentence */
CentralCamera fitCentralCamera(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const cv::Vec2d& range, int coefficients,
                               const std::string& name);

//! Throws Failure if the fit of the camera of that name has diverged: its error is NaN, or larger than the image.
void requireNear(const CentralCamera& central, const std::string& name);

//! A camera without a window is its own central camera. @param camera with its image size
CentralCamera centralCamera(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const cv::Vec2d& range);

//! A camera of a rig for programs that have no model of a window.
struct ExportedCamera
{
    std::string name;           //!< camera1, ...
    cv::Ptr<cv::refract::RefractiveCamera> trueCamera;
    RigidTransform truePose;    //!< frame of camera 1 of the calibration -> true camera
    CentralCamera central;
    RigidTransform pose;        //!< frame of camera 1 of the calibration -> central camera
};

//! The cameras to export, and the range for which they are valid.
struct CentralRig
{
    std::vector<ExportedCamera> cameras;
    std::string source;         //!< the calibration's file
    cv::Vec2d range;            //!< z, frame of each camera
    std::string unit;           //!< of length; may be empty
};

//! "rms 0.12 px, max 0.5 px, ..." of a camera.
std::string errorText(const CentralRig& rig, const ExportedCamera& camera);
//! The first lines of every file, without the comment sign.
std::string headText(const CentralRig& rig);

} // namespace tools

#endif // REFRACT_TOOLS_CENTRAL_CAMERA_HPP
