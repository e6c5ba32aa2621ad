// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_DOME_HPP
#define OPENCV_REFRACT_DOME_HPP

#include "precomp.hpp"
#include "window/dome_kernels.hpp"

namespace cv { namespace refract {

//! The faces of a dome.
std::vector<Sphere> spheresOf(const GlassWindow& window);

/** The path from a homogeneous point (x, y, z, w), w >= 0, to the camera, for what the kernel leaves: slow, and it always ends.
@param direction in which the camera sees it, not unit */
uchar findDomePath(const Dome& dome, const Vec3d& X, double w, Vec3d& direction);

}} // namespace

#endif // OPENCV_REFRACT_DOME_HPP
