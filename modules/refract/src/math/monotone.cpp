// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/monotone.hpp"

namespace cv { namespace refract {

/* In y = 1/s the leading coefficient is c[0] > 0, however small the highest one is; the largest positive root y is wanted.
Returns 0 if there is none. */
static double largestRootOfCubic(const double* c, int degree)
{
    Vec4d coefficients(0, 0, 0, 0);
    std::copy(c, c + degree + 1, &coefficients[3 - degree]);
    Vec3d roots;
    const int count = solveCubic(coefficients, roots);
    double y = 0;
    for (int i = 0; i < count; i++)
        y = std::max(y, roots[i]);
    // Newton's step repairs what the formulas' cancellation has cost, unless the root is a double one.
    for (int i = 0; i < 2 && y > 0; i++)
    {
        const Vec4d& a = coefficients;
        const double step = (((a[0]*y + a[1])*y + a[2])*y + a[3])/((3*a[0]*y + 2*a[1])*y + a[2]);
        if (std::abs(step) < 1e-6*y)
            y -= step;
    }
    return y;
}

//! c[0] y^degree + ... + c[degree]
static double valueAt(const double* c, int degree, double y, double& slope)
{
    double value = c[0];
    slope = 0;
    for (int i = 1; i <= degree; i++)
    {
        slope = slope*y + value;
        value = value*y + c[i];
    }
    return value;
}

//! The root between two places where the polynomial has different signs: Newton's steps, and halves where they are slow.
static double rootBetween(const double* c, int degree, double below, double above, bool risesThrough)
{
    double y = 0.5*(below + above), width = above - below;
    for (int i = 0; i < 200; i++)
    {
        double slope;
        const double value = valueAt(c, degree, y, slope);
        ((value > 0) == risesThrough ? above : below) = y;
        double next = y - value/slope;
        if (!(next > below && next < above) || std::abs(next - y) > 0.5*width)
            next = 0.5*(below + above);
        width = std::abs(next - y);
        y = next;
        if (width <= 2*DBL_EPSILON*y)
            break;
    }
    return y;
}

/* The positive roots up to `most`, the largest first: between two neighbouring extrema, which are the derivative's roots and as
far from zero at most (Gauss, Lucas), there is one at most. One that only touches zero is there within rounding. */
static int positiveRoots(const double* c, int degree, double most, double* roots)
{
    if (degree == 1)
    {
        roots[0] = -c[1]/c[0];
        return roots[0] > 0;
    }
    double derivative[6], extrema[6];
    for (int i = 0; i < degree; i++)
        derivative[i] = c[i]*(degree - i);
    const int extremaCount = positiveRoots(derivative, degree - 1, most, extrema);
    extrema[extremaCount] = 0;
    int count = 0;
    double above = most, valueAbove = c[0];             // its sign
    for (int i = 0; i <= extremaCount; i++)
    {
        const double below = extrema[i];
        double slope, bend;
        const double value = valueAt(c, degree, below, slope);
        valueAt(derivative, degree - 1, below, bend);
        if (value*valueAbove < 0)
            roots[count++] = rootBetween(c, degree, below, above, valueAbove > 0);
        else if (below > 0 && std::abs(value) <= 1e-14*below*below*std::abs(bend))
            roots[count++] = below;
        above = below;
        valueAbove = value;
    }
    return count;
}

//! The same for any degree up to 6.
static double largestRoot(const double* c, int degree)
{
    CV_Assert(degree <= 6);
    double most = 0, roots[7];
    for (int i = 1; i <= degree; i++)
        most = std::max(most, 2*std::pow(std::abs(c[i]/c[0]), 1./i));      // Fujiwara's bound
    return positiveRoots(c, degree, most, roots) > 0 ? roots[0] : 0;
}

double firstPositiveRoot(const double* c, int terms)
{
    int degree = terms - 1;
    while (degree > 0 && c[degree] == 0)
        degree--;
    const double y = degree < 1 ? 0 : degree <= 3 ? largestRootOfCubic(c, degree) : largestRoot(c, degree);
    return y > 0 ? 1/y : std::numeric_limits<double>::infinity();
}

void fitPolynomial(int n, double* x, double* y)
{
    // Newton's divided differences in y, ...
    for (int k = 1; k < n; k++)
        for (int i = n - 1; i >= k; i--)
            y[i] = (y[i] - y[i - 1])/(x[i] - x[i - k]);
    // ... multiplied out from the inside.
    for (int k = n - 2; k >= 0; k--)
        for (int i = k; i < n - 1; i++)
            y[i] -= x[k]*y[i + 1];
}

}} // namespace
