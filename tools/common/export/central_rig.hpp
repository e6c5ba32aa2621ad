// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CENTRAL_RIG_HPP
#define REFRACT_TOOLS_CENTRAL_RIG_HPP

#include "export/central_camera.hpp"

namespace tools {

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

#endif // REFRACT_TOOLS_CENTRAL_RIG_HPP
