// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_POSE_START_HPP
#define OPENCV_REFRACT_POSE_START_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

//! Where a fit begins.
struct RigStart
{
    Rig rig;
    std::vector<Pose> poses;        //!< of the views
};

/** Start of every view's pose, object -> camera 1, as far as it can be had without any window: the known pose, else from
the direct image with the most points. */
std::vector<Pose> posesWithoutWindow(const Rig& rig, const RigViews& views, const std::vector<Pose>& known);

//! The other poses, from images through the windows; not found where no image gives one.
void addPosesThroughWindow(const Rig& rig, const RigViews& views, std::vector<Pose>& poses);

//! The poses that are left, as if there were no window: to know roughly how far a target is where a window's start hides it.
void addPosesIgnoringWindow(const Rig& rig, const RigViews& views, std::vector<Pose>& poses);

//! Whether every point that the camera saw through its window has an image there.
bool showsWhatWasSeen(const Rig& rig, int c, const RigViews& views, const std::vector<Pose>& poses);

/** The other poses, from images through the windows. Where these hide a target, windows of unknown distance come nearer to their cameras,
until all that was seen has an image.
@return false if some has none at any distance: the windows, and the poses as far as they were found, are those of the given ones */
bool placeTargets(Rig& rig, const RigViews& views, int flags, std::vector<Pose>& poses);

//! Some image of the view has a point.
bool hasPoints(const RigViews& views, int view);

//! NO_POSE if a view that has points has none.
FitOutcome checkPoses(const RigViews& views, const std::vector<Pose>& poses);

}} // namespace

#endif // OPENCV_REFRACT_POSE_START_HPP
