// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_NEAREST_RAYS_HPP
#define OPENCV_REFRACT_NEAREST_RAYS_HPP

#include "pose/poses.hpp"

namespace cv { namespace refract {

/** The pose with the least distances of the points to their pixels' rays, by angle, near a start. The rays are lines in the scene:
unlike its reprojection error, a point before the window has such a distance.
@return the start, if that has no such distances */
Pose nearestToRays(const Camera& camera, const ImagePoints& points, const Pose& start);

}} // namespace

#endif // OPENCV_REFRACT_NEAREST_RAYS_HPP
