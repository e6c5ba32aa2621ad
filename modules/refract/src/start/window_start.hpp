// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_WINDOW_START_HPP
#define OPENCV_REFRACT_WINDOW_START_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

//! A second minimum of the cost of a window that only images through it tell of.
struct OtherMinimum
{
    Vec3d normal = Vec3d::all(std::numeric_limits<double>::quiet_NaN());    //!< in the owner's frame
    //! Root of the difference of the squared errors, in standard deviations of a pixel.
    double excess = std::numeric_limits<double>::quiet_NaN();
    double distance = std::numeric_limits<double>::quiet_NaN();
};

//! OtherMinimum::excess of a fit whose squared error is `cost`.
double excessOf(double cost, double best, int freedom);

//! Windows whose normals differ by less are one minimum: radians.
const double SAME_ANGLE = 0.01;
double angleBetween(const Vec3d& a, const Vec3d& b);

/** Start of every window: its normal and, if free, its distance; the rest as given.

From pairs if there are any; a pose that is known without the window makes every image of its view one of a pair. Else,
with the lens known, some views are fitted from the best few of a ring of tilts, as the cost through the window alone has
more than one minimum, and all views from each distinct one of these; the least cost wins. Else the given window.
A window of unknown distance that is shared is described from now on in the frame of the camera nearest to it (rig.owner): its
distance has a bound at 0, so that no camera comes to lie beyond. Where the start puts one there, the window moves out.
@param others one per camera; only the given owner's may hold a second minimum
@return LOOKS_AWAY if some camera looks away from its window then */
FitOutcome startWindows(Rig& rig, const RigViews& views, const std::vector<Pose>& poses, int flags,
                        std::vector<OtherMinimum>& others);

/** The given normal for a window whose start hides what was seen through it: noisy pairs through a thin window have their least
error anywhere. */
FitOutcome keepGivenNormals(const Rig& given, const RigViews& views, const std::vector<Pose>& poses, Rig& rig);

//! The window as another camera sees it.
GlassWindow transferred(GlassWindow window, const Pose& from, const Pose& to);
//! The cameras that do not own their window get what they see of it. LOOKS_AWAY if one does.
FitOutcome transferToOthers(Rig& rig);
//! Gives every shared window to the camera that is nearest to it.
void giveToNearest(Rig& rig);

//! The distance of every window from its owner; false if some camera then looks away from it.
bool setDistances(Rig& rig, double distance);
//! The normal of the window of an owner, in its frame; false if some camera then looks away from it.
bool setNormal(Rig& rig, int owner, const Vec3d& normal);

}} // namespace

#endif // OPENCV_REFRACT_WINDOW_START_HPP
