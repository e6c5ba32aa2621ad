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

/** Where light of large moment is lost, the paths that there may be: without passing the centre; by it and across the axis behind it; or
by it on the point's own side, with more of a turn or with less. */
enum DomeWay { OUTWARDS, ACROSS_AXIS, BY_CENTER_MORE, BY_CENTER_LESS, DOME_WAYS };

//! The path of that kind, if there is one.
bool findDomeWay(const Dome& dome, const Vec3d& X, double w, DomeWay way, Vec3d& direction);

}} // namespace

#endif // OPENCV_REFRACT_DOME_HPP
