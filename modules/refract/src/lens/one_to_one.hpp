// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_ONE_TO_ONE_HPP
#define OPENCV_REFRACT_ONE_TO_ONE_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

/** Of a grid's cells those that a map of the plane keeps apart.

They hang together with the cell in the middle, at no corner of them the map folds back, and none is seen (its bounding box)
where one nearer to the middle is seen that is not next to it.

@param seen where the map takes the corners, (rows + 1) x (cols + 1)
@param isRegular of each corner: the map does not fold back there
@return rows x cols, 1 or 0 */
Mat1b oneToOneCells(const Mat2d& seen, const Mat1b& isRegular);

}} // namespace

#endif // OPENCV_REFRACT_ONE_TO_ONE_HPP
