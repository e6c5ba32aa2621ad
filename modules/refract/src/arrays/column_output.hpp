// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_COLUMN_OUTPUT_HPP
#define OPENCV_REFRACT_COLUMN_OUTPUT_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

/** One item a point, a camera or a view; nothing if they are not wanted. A caller's array keeps its type, if that is fixed, and its
shape of one row. */
void writeColumn(const Mat& column, OutputArray out);

}} // namespace

#endif // OPENCV_REFRACT_COLUMN_OUTPUT_HPP
