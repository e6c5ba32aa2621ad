// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNELS_ANGLES_HPP
#define OPENCV_REFRACT_KERNELS_ANGLES_HPP

#include "simd/lanes.hpp"
#include "simd/polynomial.hpp"

/* Angles of all lanes at once, to the accuracy of double. */

namespace cv { namespace refract { namespace {

const double PI = 3.14159265358979311600, PI_REST = 1.22464679914735317723e-16;    // together 106 bits

/** Angle of (x, y) to the x axis, y >= 0. The ratio of the two, turned by 45 degrees where that makes it smaller, is at
most tan(22.5 degrees); there the Chebyshev fit of (atan(t)/t - 1)/t^2 with 11 terms in t^2 is good to 5e-18. */
inline Lanes angleOf(Lanes x, Lanes y)
{
    const double C[] = { -0.3333333333333333016, 0.1999999999999551655, -0.1428571428466568076, 0.1111111101518701872,
                         -0.09090904575306489084, 0.0769218312537689209, -0.06664510525508936599,
                         0.05858140904866328282, -0.05085407834589484257, 0.03923044778479309523,
                         -0.01917540471110493368 };
    const Lanes a = absolute(x);
    const Mask steep = y > a;
    const Lanes low = select(steep, a, y), high = select(steep, y, a);
    const Mask turn = low > 0.41421356237309503*high;
    const Lanes t = select(turn, low - high, low)/select(turn, low + high, larger(high, all(1e-300)));
    const Lanes t2 = t*t;
    Lanes angle = t + t*t2*polynomial(C, t2);
    angle += select(turn, all(PI/4), all(0));
    angle = select(steep, (PI/2 - angle) + PI_REST/2, angle);
    return select(x < 0, (PI - angle) + PI_REST, angle);
}

//! Sine and cosine of 0 <= angle <= pi, by their series within 45 degrees of the nearest multiple of 90.
inline void sineCosine(Lanes angle, Lanes& sine, Lanes& cosine)
{
    const double S[] = { -1./6, 1./120, -1./5040, 1./362880, -1./39916800, 1./6227020800., -1./1307674368000.,
                         1./355687428096000. };
    const double C[] = { 1./24, -1./720, 1./40320, -1./3628800, 1./479001600, -1./87178291200., 1./20922789888000. };
    const Mask first = angle < PI/4, last = angle > 3*PI/4;
    const Lanes turns = select(first, all(0), select(last, all(2), all(1)));
    const Lanes a = (angle - turns*(PI/2)) - turns*(PI_REST/2), a2 = a*a;
    const Lanes s = a + a*a2*polynomial(S, a2), c = 1 - 0.5*a2 + a2*a2*polynomial(C, a2);
    sine = select(first, s, select(last, -s, c));
    cosine = select(first, c, select(last, -c, -s));
}

}}} // namespace

#endif // OPENCV_REFRACT_KERNELS_ANGLES_HPP
