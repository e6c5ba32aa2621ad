// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_POLYNOMIAL_HPP
#define OPENCV_REFRACT_POLYNOMIAL_HPP

#include "simd/lanes.hpp"

namespace {

//! c[0] + x (c[1] + x (...)), for one point (T = double) and for many (T = Lanes).
template<int N, typename T>
inline T polynomial(const double (&c)[N], T x)
{
    T sum = c[N - 1] + T();
    for (int k = N - 2; k >= 0; k--)
        sum = sum*x + c[k];
    return sum;
}

/** A ratio near 1 as a series: 1 + x (c[0] + x (c[1] + ...)), or 1 where x is so far out that the series says nothing. */
template<int N, typename T>
inline T guessRatio(const double (&c)[N], T x)
{
    const T series = 1 + x*polynomial(c, x);
    return select((series > 0.5) & (series < 2), series, 1 + T());
}

} // namespace

#endif // OPENCV_REFRACT_POLYNOMIAL_HPP
