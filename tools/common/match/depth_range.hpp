// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DEPTH_RANGE_HPP
#define REFRACT_TOOLS_DEPTH_RANGE_HPP

#include "calibrate/calib_file.hpp"

/* z of a scene, in the frame of camera 1. */
namespace tools {

//! Cameras in which imageSize() is known and a z that their windows leave free.
bool isBeyondWindows(const Calibration& calibration, double z);

//! What --depth=NEAR,FAR says; throws Failure where that is no range, or not of a scene beyond the window.
cv::Vec2d givenDepthRange(const std::string& text, const Calibration& calibration);

//! Half as far as the calibrated volume, to half as far again beyond it; throws Failure that asks for --depth if the file has none.
cv::Vec2d calibratedDepthRange(const Calibration& calibration, const std::string& filename);

//! What a camera sees on a plane of its own frame, in steps + 1 rows and columns all over its image; NaN where it does not see the plane.
std::vector<cv::Point3d> pointsAtDepth(const cv::Ptr<cv::refract::RefractiveCamera>& camera, double z, int steps);

} // namespace tools

#endif // REFRACT_TOOLS_DEPTH_RANGE_HPP
