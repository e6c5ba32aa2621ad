// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/monotone.hpp"
#include <Eigen/Eigenvalues>

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

//! The same for any degree up to 6: the eigenvalues of the companion matrix.
static double largestRoot(const double* c, int degree)
{
    typedef Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> Companion;   // not on the heap
    CV_Assert(degree <= Companion::MaxRowsAtCompileTime);
    Companion companion = Companion::Zero(degree, degree);
    for (int i = 0; i < degree; i++)
        companion(0, i) = -c[i + 1]/c[0];
    companion.diagonal(-1).setOnes();
    const auto roots = companion.eigenvalues();
    double y = 0;
    for (int i = 0; i < degree; i++)
        if (std::abs(roots[i].imag()) <= 1e-7*std::abs(roots[i]))
            y = std::max(y, roots[i].real());
    return y;
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
