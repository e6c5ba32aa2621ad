// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RIG_MODEL_HPP
#define REFRACT_TOOLS_RIG_MODEL_HPP

#include "calibrate/calib_file.hpp"

/* Cameras behind their windows, and where they are to each other. */
namespace tools {

//! What is known of a camera before its images are looked at: from a file, from a data sheet.
struct KnownCamera
{
    cv::Mat lens;                               //!< its parameters
    cv::refract::GlassWindow window;            //!< its given values
    cv::Mat covariance;         //!< as calibrateGlassRig's cameraCovariances, where the values are those; empty: nothing
};

//! Lenses, windows and their places: the start of a fit and its result.
struct RigModel
{
    std::vector<cv::Ptr<cv::refract::RefractiveCamera>> cameras;
    std::vector<RigidTransform> extrinsics = {};    //!< camera 1 -> each camera; the first is the identity
    std::vector<int> windows = {};              //!< which window each camera looks through; empty: each has its own
    std::vector<KnownCamera> known = {};        //!< one per camera, or empty
    cv::Mat targetCovariance = {};              //!< as calibrateGlassRig's; empty: targets are as given
    double targetScale = 1.;                    //!< by which they are larger than given
    RigidTransform targetMotion = {};           //!< of all of them between direct and glass images, in camera 1

    RigModel clone() const;
    //! A camera at the end, where it is from camera 1.
    void add(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const RigidTransform& cam_from_cam1 = RigidTransform());
    //! The first of those that look through a window: its parameters are the window's.
    bool ownsWindow(int camera) const;
    bool sharesWindow(int camera, int other) const;
};

int countWindows(const RigModel& rig);

/** One window from another camera. For a camera that is taken to be beyond it, it is at the camera: between equal media any distance will
do, or with a wedge nearly so, and elsewhere a trial goes no farther.
@param there from the frame of the camera that it is described for, to that of the other */
cv::refract::GlassWindow seenFrom(const cv::refract::GlassWindow& window, const RigidTransform& there);
//! All that look through the window of one camera get it as they see it.
void shareWindow(RigModel& rig, int owner);

//! Same lens, other window.
cv::Ptr<cv::refract::RefractiveCamera> copyWithWindow(const cv::Ptr<cv::refract::RefractiveCamera>& camera,
                                                      const cv::refract::GlassWindow& window);

/* Images that are given as through a window, though it was out. */

//! All cameras with a window, each, and those of each pane.
std::vector<std::vector<int>> camerasWithoutWindows(const RigModel& rig);
//! What is said of it: "images of camera 2 taken without ...". @param count of the rig's cameras
std::string takenWithoutWindow(const std::vector<int>& cameras, int count);

const int TARGET_ERRORS = 7;                    //!< rows of targetCovariance

//! A target's points as they are, from what is given.
std::vector<cv::Point3d> pointsOfTarget(const RigModel& rig, std::vector<cv::Point3d> objectPoints);

//! Board -> a camera of the rig, from board -> camera 1.
void poseInCamera(const RigModel& rig, int camera, cv::Vec3d& rvec, cv::Vec3d& tvec);
//! The same in one of its images: between direct and glass images the targets may have moved.
void poseInImage(const RigModel& rig, int camera, bool glass, cv::Vec3d& rvec, cv::Vec3d& tvec);
//! The ways back.
void poseFromImage(const RigModel& rig, int camera, bool glass, cv::Vec3d& rvec, cv::Vec3d& tvec);
void poseInCamera1(const RigModel& rig, int camera, cv::Vec3d& rvec, cv::Vec3d& tvec);

//! What a file says of them; each window by itself, as one that moved no longer is where the others are.
RigModel modelOf(const Calibration& calibration);

/** Points that the cameras of a rig see, in camera 1, by triangulateRefractive; NaN where there is none.
@param pixels of each camera, one a point, NaN where it does not see it. @param method TRIANGULATE_OPTIMAL or TRIANGULATE_MIDPOINT
@param reprojectionErrors px, a row a point, a column a camera */
std::vector<cv::Point3d> triangulate(const RigModel& rig, const std::vector<std::vector<cv::Point2d>>& pixels,
                                     int method = cv::refract::TRIANGULATE_OPTIMAL, cv::OutputArray reprojectionErrors = cv::noArray());

//! Cameras 1 and 2 alone, with what the covariance says of them.
Calibration firstTwoCameras(const Calibration& rig);

//! As a file of it would be, without what the estimate is worth.
Calibration calibrationOf(const RigModel& rig);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_MODEL_HPP
