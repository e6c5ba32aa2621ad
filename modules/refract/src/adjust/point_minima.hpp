// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_POINT_MINIMA_HPP
#define OPENCV_REFRACT_POINT_MINIMA_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

/** Other minima of a scene's points, the cameras staying: a known length meets a line of sight twice, and so may the bent sheet that half
a pixel sees; images that hardly tell which of the two is right leave a minimum at each. Each cluster of points goes to the least that is
found.
@return whether one has gone to another than where it was */
bool moveToLeastMinima(Problem& problem);
/** The same; the points where they are then, but NaN where another minimum is nearly as low, and where three coordinates do not meet. Of a
cluster, points stay that rays have once without the others. */
std::vector<Point3d> pointsOfOneMinimum(Problem& problem, double lead);
//! NaN: points that are where as many equations have them whatever the cameras, so that they tell nothing of these.
std::vector<Point3d> pointsThatTell(const Problem& problem);

}} // namespace

#endif // OPENCV_REFRACT_POINT_MINIMA_HPP
