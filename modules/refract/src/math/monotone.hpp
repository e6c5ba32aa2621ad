// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_MONOTONE_HPP
#define OPENCV_REFRACT_MONOTONE_HPP

#include "precomp.hpp"

/* Radial functions that increase from 0 up to a limit: where they end, and their inverse. */

namespace cv { namespace refract {

//! Smallest positive real root of sum_k coefficients[k] s^k, infinity if there is none. coefficients[0] > 0, at most 7 terms.
double firstPositiveRoot(const double* coefficients, int terms);

/** Solves f(x) = target for 0 <= x < upper, where f increases from f(0) = 0; upper may be infinite.
@param f callable: f(x, derivative&) -> value
@return x, or NaN if target lies beyond f(upper) */
template<typename F>
double invertMonotone(const F& f, double target, double upper)
{
    double low = 0, high = upper, x = std::min(target, 0.5*upper), slope;
    if (!(target > 0) || !std::isfinite(target))
        return target == 0 ? 0 : std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i < 200; i++)
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

//! The polynomial through n points (x, y), its coefficients by rising power in y.
void fitPolynomial(int n, double* x, double* y);

/** Where a search for the inverse of f, f(x) = x (1 + O(x^2)), begins: x = y (1 + y^2 (c[0] + c[1] y^2 + ...)), exact at n
values of x up to `upper`, spread as Chebyshev's nodes.
@param f callable: f(x, derivative&) -> value */
template<typename F>
void fitInverse(const F& f, double upper, int n, double* c)
{
    AutoBuffer<double> y2(n);
    for (int i = 0; i < n; i++)
    {
        double slope;
        const double x = upper*std::cos(0.25*CV_PI*(2*i + 1)/n), y = f(x, slope);
        y2[i] = y*y;
        c[i] = (x/y - 1)/y2[i];
    }
    fitPolynomial(n, y2.data(), c);
}

}} // namespace

#endif // OPENCV_REFRACT_MONOTONE_HPP
