// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_ONE_DISTANCE_HPP
#define OPENCV_REFRACT_ONE_DISTANCE_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

//! Whether the rays to most points of a scene are so parallel that poses which are a little off let them meet anywhere.
bool areRaysParallel(const Problem& problem);

/** Places a scene's points at one distance, which is what its lengths tell, and the poses that are free where these have them.
@return false if no length tells it: nothing has changed */
bool placeAtOneDistance(Problem& problem);

}} // namespace

#endif // OPENCV_REFRACT_ONE_DISTANCE_HPP
