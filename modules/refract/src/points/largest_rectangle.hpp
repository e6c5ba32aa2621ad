// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LARGEST_RECTANGLE_HPP
#define OPENCV_REFRACT_LARGEST_RECTANGLE_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

//! The largest rectangle within limits round a seed that has none of the points inside.
Rect2d largestRectangle(const Point2d& seed, const Rect2d& limits, std::vector<Point2d> points);

}} // namespace

#endif // OPENCV_REFRACT_LARGEST_RECTANGLE_HPP
