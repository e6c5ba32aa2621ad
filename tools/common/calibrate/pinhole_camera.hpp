// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PINHOLE_CAMERA_HPP
#define REFRACT_TOOLS_PINHOLE_CAMERA_HPP

#include "calibrate/calib_file.hpp"
#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"
#include <opencv2/refract.hpp>
#include <map>
#include <string>
#include <vector>

namespace tools {

//! Where a number of cv::calibrateCamera's coefficients may stand: cv::fisheye's model instead, which has four.
const int FISHEYE_LENS = -1;
const int INTRINSICS = 4;       //!< fx, fy, cx, cy: the parameters of a lens before its distortion coefficients

//! A lens model that OpenCV calibrates.
struct PinholeLens
{
    int coefficients;           //!< or FISHEYE_LENS
    int flags;                  //!< cv::calibrateCamera's
};

//! All of them, by the names that --lens takes.
const std::map<std::string, PinholeLens>& pinholeLenses();

//! What one camera saw of one target.
struct TargetView
{
    std::vector<cv::Point3d> objectPoints;
    std::vector<cv::Point2d> pixels;            //!< NaN where a point was not seen; empty: no view
};

/** cv::calibrateCamera on the seen points of all views that are not empty; where a target is not flat, from several focal
lengths. With FISHEYE_LENS cv::fisheye::calibrate, on flat targets, from several focal lengths too. Throws cv::Exception where
it finds nothing.
@param fixed GLASS_FIX_...: k1 to k4, p1 and p2 that stay 0
@param solver of cv::calibrateCamera's steps, a flag of it; 0: by singular values, which takes most of its time and bears what images
hardly determine */
cv::Ptr<cv::refract::RefractiveCamera> calibratePinhole(const std::vector<TargetView>& views, cv::Size imageSize,
                                                     int coefficients, int fixed, double& rms, int solver = 0);

//! Of the views that a camera has, directly or through the window.
std::vector<TargetView> targetViewsOf(const RigData& data, int camera, bool glass);

//! Whether there are enough images to find a lens from: three of flat targets, one of a target with depth.
bool determineLens(const std::vector<TargetView>& views);

//! Whether a target has depth of its own, so that one view of it tells the focal length.
bool isSolid(const std::vector<cv::Point3d>& objectPoints);

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

#endif // REFRACT_TOOLS_PINHOLE_CAMERA_HPP
