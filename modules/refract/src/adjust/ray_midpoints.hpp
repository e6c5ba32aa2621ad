// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RAY_MIDPOINTS_HPP
#define OPENCV_REFRACT_RAY_MIDPOINTS_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

/** Where a scene's points start: as given or, where that is NaN, where the rays of all images that see it come closest; NaN
if fewer than two do, if their rays are parallel, or if one of these images could not see the point where it would be. */
std::vector<Point3d> startPoints(const Problem& problem, const std::vector<Point3d>& given);

/** Where the rays of some observations come closest; NaN where there are fewer than two, or they are parallel.
@param isUsed per image, per point of it */
std::vector<Point3d> rayMidpoints(const Problem& problem, int pointCount, const std::vector<std::vector<uchar> >& isUsed);

}} // namespace

#endif // OPENCV_REFRACT_RAY_MIDPOINTS_HPP
