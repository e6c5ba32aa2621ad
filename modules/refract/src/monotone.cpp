// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "monotone.hpp"
#include <Eigen/Eigenvalues>

namespace cv { namespace refract {

double firstPositiveRoot(std::vector<double> c)
{
    while (c.size() > 1 && c.back() == 0)
        c.pop_back();
    const int degree = (int)c.size() - 1;
    double first = std::numeric_limits<double>::infinity();
    if (degree < 1)
        return first;
    // In 1/s the leading coefficient is c[0] = 1, however small the highest one is: eigenvalues of the companion
    // matrix, of which the largest positive real one is wanted.
    typedef Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> Companion;   // not on the heap
    CV_Assert(degree <= Companion::MaxRowsAtCompileTime);
    Companion companion = Companion::Zero(degree, degree);
    for (int i = 0; i < degree; ++i)
        companion(0, i) = -c[i + 1]/c[0];
    companion.diagonal(-1).setOnes();
    const auto roots = companion.eigenvalues();
    for (int i = 0; i < degree; ++i)
        if (roots[i].real() > 0 && std::abs(roots[i].imag()) <= 1e-7*std::abs(roots[i]))
            first = std::min(first, 1/roots[i].real());
    return first;
}

void fitPolynomial(int n, double* x, double* y)
{
    // Newton's divided differences in y, ...
    for (int k = 1; k < n; ++k)
        for (int i = n - 1; i >= k; --i)
            y[i] = (y[i] - y[i - 1])/(x[i] - x[i - k]);
    // ... multiplied out from the inside.
    for (int k = n - 2; k >= 0; --k)
        for (int i = k; i < n - 1; ++i)
            y[i] -= x[k]*y[i + 1];
}

}} // namespace
