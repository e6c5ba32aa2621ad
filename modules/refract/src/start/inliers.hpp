// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_INLIERS_HPP
#define OPENCV_REFRACT_INLIERS_HPP

#include "start/pose_start.hpp"

namespace cv { namespace refract {

/** The views without the points that agree with no common pose of their image, to start from. Images without a pose
become empty. A window that may be elsewhere makes outliers of right points where it is given: they are chosen behind the one of several
places of which most agree. */
RigViews inlierViews(const Rig& rig, const RigViews& views, int flags);

}} // namespace

#endif // OPENCV_REFRACT_INLIERS_HPP
