// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_START_HPP
#define OPENCV_REFRACT_RIG_START_HPP

#include "poses.hpp"
#include "views.hpp"

namespace cv { namespace refract {

/** Start of one camera's window: its normal and, if free, its distance; the rest as given.

From pairs if there are any. Else, with the lens known, some views are fitted from the best few of a ring of tilts, as the
cost through the window alone has more than one minimum, and all views from each of these and from the given window; the
least cost wins. Else the given window. */
GlassWindow startWindow(const Camera& camera, const CameraViews& seen, const std::vector<std::vector<Point3d> >& object,
                        int flags);

/** Start of every view's pose, object -> camera 1: from its direct image with the most points, else from one through the
window. Throws, naming the view, if no image gives a pose. */
std::vector<Pose> startPoses(const std::vector<Camera>& cameras, const Pose& extrinsics, const RigViews& views);

}} // namespace

#endif // OPENCV_REFRACT_RIG_START_HPP
