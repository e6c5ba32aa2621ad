// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_MOVED_IMAGES_HPP
#define OPENCV_REFRACT_MOVED_IMAGES_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

/** Images whose target is not where the view's other images have it, as indices into rig.images(). The view's pose becomes
that of the images that stay.
@param scale standard deviation of a pixel coordinate */
std::vector<int> findMovedImages(Problem& rig, double scale);

}} // namespace

#endif // OPENCV_REFRACT_MOVED_IMAGES_HPP
