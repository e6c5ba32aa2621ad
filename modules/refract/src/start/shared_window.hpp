// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SHARED_WINDOW_HPP
#define OPENCV_REFRACT_SHARED_WINDOW_HPP

#include "adjust/problem.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

//! The window as another camera sees it.
GlassWindow transferred(GlassWindow window, const Pose& from, const Pose& to);
//! The cameras that do not own their window get what they see of it. LOOKS_AWAY if one does, BEYOND_WINDOW if one is outside a dome.
FitOutcome transferToOthers(Rig& rig);
//! Gives every shared window to the camera that is nearest to it.
void giveToNearest(Rig& rig);

//! The distance of every window that has one from its owner; false if some camera then looks away from it.
bool setDistances(Rig& rig, double distance);
bool scaleDistances(Rig& rig, double factor);
//! The place of the window of an owner, in its frame; false if some camera then looks away from it.
bool setPlace(Rig& rig, int owner, const WindowPlace& place);

}} // namespace

#endif // OPENCV_REFRACT_SHARED_WINDOW_HPP
