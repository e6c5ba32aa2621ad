// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_STEREOGRAPHIC_MODEL_HPP
#define OPENCV_REFRACT_STEREOGRAPHIC_MODEL_HPP

#include "simd/lanes.hpp"

/* The stereographic projection 2 (X, Y)/(|d| + Z), for one point (T = double) and for many (T = Lanes). */

namespace cv { namespace refract { namespace {

//! |d| + Z, without its cancellation behind the camera. r2 = X^2 + Y^2
template<typename T>
inline T stereographicDivisor(T r2, T length, T z) { return select(z >= 0, length + z, r2/(length - z)); }

}}} // namespace

#endif // OPENCV_REFRACT_STEREOGRAPHIC_MODEL_HPP
