// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/f_distribution.hpp"
#include <opencv2/core/cvdef.h>
#include <algorithm>
#include <cmath>

namespace tools {

double upperTailF(int m, double v, double x)
{
    if (!(x > 0))
        return 1.;
    const double odds = 2.*m*x/v, logW = -std::log1p(odds), logRest = std::log(odds) + logW;
    double sum = 0., logTerm = 0.5*v*logW;      // term by term in logarithms: the factors alone overflow
    for (int j = 0; j < m; j++)
    {
        sum += std::exp(logTerm);
        logTerm += std::log((0.5*v + j)/(j + 1.)) + logRest;
    }
    return std::min(1., sum);
}

double upperTailAnyF(int k, double v, double x)
{
    if (k % 2 == 0)
        return upperTailF(k/2, v, x);
    if (!(x > 0))
        return 1.;
    const double odds = k*x/v, logW = -std::log1p(odds), logRest = std::log(odds) + logW, a = 0.5*v;
    const double z = (8.*v + 1.)/(8.*v + 3.)*std::sqrt(-v*logW);
    double sum = std::erfc(z/std::sqrt(2.));
    // Gamma(a + 1/2)/Gamma(a), over Gamma(3/2)
    double logTerm = 0.5*std::log(a) + std::log1p(-1./(8.*a) + 1./(128.*a*a)) - std::log(0.5*std::sqrt(CV_PI)) + a*logW + 0.5*logRest;
    for (int j = 0; j < (k - 1)/2; j++)
    {
        const double b = j + 0.5;
        sum += std::exp(logTerm);
        logTerm += std::log((a + b)/(b + 1.)) + logRest;
    }
    return std::min(1., sum);
}

double quantileF(int k, double v, double probability)
{
    const double ofTwo = 0.5*v*std::expm1(-2./v*std::log(probability));
    if (k == 2)
        return ofTwo;
    double low = 0., high = ofTwo;
    while (upperTailAnyF(k, v, high) > probability)
        high *= 2.;
    for (int i = 0; i < 100 && high - low > 1e-12*high; i++)
        (upperTailAnyF(k, v, 0.5*(low + high)) > probability ? low : high) = 0.5*(low + high);
    return 0.5*(low + high);
}

double upperTailNoncentralF(int k, double v, double lambda, double x)
{
    // A Poisson mixture of central ones; from where it is largest, terms fall off fast to both sides.
    const int last = (int)(0.5*lambda + 10.*std::sqrt(0.5*lambda) + 30.);
    double sum = 0., logFactorial = 0.;         // std::lgamma would write to a variable that all threads share
    for (int j = 0; j <= last; j++)
    {
        logFactorial += std::log(std::max(j, 1));
        const double logWeight = (lambda > 0 ? j*std::log(0.5*lambda) : j ? -HUGE_VAL : 0.) - 0.5*lambda - logFactorial;
        sum += std::exp(logWeight)*upperTailAnyF(k + 2*j, v, k*x/(k + 2*j));
    }
    return std::min(1., sum);
}

} // namespace tools
