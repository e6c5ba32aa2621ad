// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_MODERATE_HPP
#define OPENCV_REFRACT_MODERATE_HPP

#include "simd/lanes.hpp"

/* Points with which one can compute. No OpenCV in here, see dispatch/kernels.hpp. */

namespace cv { namespace refract {

//! Products of a few coordinates that are less than this and more than its inverse are numbers.
const double MODERATE = 1.606938044258990276e60;    // 2^200

namespace {

//! Where points are farther than that, or nearer than its inverse; not where they are NaN.
inline Mask isExtreme(Lanes x, Lanes y, Lanes z)
{
    const Lanes square = x*x + y*y + z*z;
    return (square > MODERATE*MODERATE) | (square < 1/(MODERATE*MODERATE));
}

}}} // namespace

#endif // OPENCV_REFRACT_MODERATE_HPP
