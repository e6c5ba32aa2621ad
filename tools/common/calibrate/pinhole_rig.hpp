// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PINHOLE_RIG_HPP
#define REFRACT_TOOLS_PINHOLE_RIG_HPP

#include "calibrate/calib_file.hpp"
#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"

namespace tools {

/* What a user would do instead: the same images through the window, given to cv::calibrateCamera and
cv::stereoCalibrate as if there were none. They throw Failure (or cv::Exception) where that cannot be done. */

//! @param coefficients of the lens: 0, 4, 5, 8, 12 or 14, or FISHEYE_LENS
CameraCalibration calibratePinholeThroughGlass(const RigData& data, int camera, const std::vector<int>& views,
                                               int coefficients);

/** All cameras, the extrinsics of each from the camera with which it has most views in common; rms is the root mean square of those of
cv::stereoCalibrate. */
Calibration calibratePinholeRig(const RigData& data, const std::vector<int>& views, int coefficients);

//! Number of coefficients of a camera's lens as cv::calibrateCamera would find it, or FISHEYE_LENS; none that a choice only left open.
int pinholeCoefficients(const RigModel& rig, int camera);

} // namespace tools

#endif // REFRACT_TOOLS_PINHOLE_RIG_HPP
