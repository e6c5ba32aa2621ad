// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_MONOTONE_HPP
#define OPENCV_REFRACT_MONOTONE_HPP

#include "precomp.hpp"

/* Radial functions that increase from 0 up to a limit: where they end, and their inverse. */

namespace cv { namespace refract {

//! Smallest positive real root of sum_k coefficients[k] s^k, infinity if there is none. coefficients[0] > 0.
double firstPositiveRoot(std::vector<double> coefficients);

/** Reversal of a series: y = x (1 + a[0] x^2 + a[1] x^4 + ...) -> x = y (1 + b[0] y^2 + b[1] y^4 + ...), four terms.
Where a search for x begins that does not go far. */
void invertSeries(const double* a, double* b);

/** Solves f(x) = target for 0 <= x < upper, where f increases from f(0) = 0; upper may be infinite.
@param f callable: f(x, derivative&) -> value
@return x, or NaN if target lies beyond f(upper) */
template<typename F>
double invertMonotone(const F& f, double target, double upper)
{
    double low = 0, high = upper, x = std::min(target, 0.5*upper), slope;
    if (!(target > 0))
        return target == 0 ? 0 : std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i < 200; ++i)
    {
        const double error = f(x, slope) - target;
        (error > 0 ? high : low) = x;
        double next = x - error/slope;
        if (!(next > low && next < high))       // Newton left the bracket: bisect it, or widen it
            next = std::isfinite(high) ? 0.5*(low + high) : 4*std::max(low, 1.);
        if (std::abs(next - x) <= 2*DBL_EPSILON*x)
        {
            // At the end of the range the sequence creeps up to `upper` without reaching the target. Next to a pole a
            // rounding of x alone moves f by slope * x.
            const double miss = std::abs(f(next, slope) - target);
            return miss <= 1e-13*(1 + target) + 4*DBL_EPSILON*slope*next ? next
                                                                         : std::numeric_limits<double>::quiet_NaN();
        }
        if (error < 0 && next > 1e8)            // f is bounded below the target
            break;
        x = next;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

}} // namespace

#endif // OPENCV_REFRACT_MONOTONE_HPP
