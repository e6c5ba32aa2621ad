// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_WEDGE_PATH_HPP
#define OPENCV_REFRACT_WEDGE_PATH_HPP

#include "precomp.hpp"
#include "window/faces.hpp"

namespace cv { namespace refract {

//! Whether light that leaves the camera in a direction (window's frame) gets out of the window; if not, why.
uchar statusOfDirection(const TiltedFaces& window, const Vec3d& direction);

/** The path from a homogeneous point (x, y, z, w), w >= 0, to the camera, for what the kernel leaves: slow, and it always ends.
@param direction in which the camera sees it, not unit; all in the window's frame */
uchar findWedgePath(const TiltedFaces& window, const Vec3d& X, double w, Vec3d& direction);

}} // namespace

#endif // OPENCV_REFRACT_WEDGE_PATH_HPP
