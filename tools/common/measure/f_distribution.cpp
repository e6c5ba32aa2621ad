// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/f_distribution.hpp"
#include <opencv2/core/cvdef.h>
#include <algorithm>
#include <cmath>

namespace tools {

namespace {

/** P(F > x) for k, k + 2, k + 4, ... and v degrees of freedom, one after the other, where k x is the same in all: each has one term
more than the one before. In logarithms: the factors alone overflow. */
class TailsOfF
{
public:
    TailsOfF(int k, double v, double kx) : a_(0.5*v)
    {
        const double odds = kx/v, logW = -std::log1p(odds);
        logRest_ = std::log(odds) + logW;
        logTerm_ = a_*logW;
        if (k % 2)
            beginWithStudent(v, logW);
        for (int i = 2 + k % 2; i <= k; i += 2)
            next();
    }

    double tail() const { return std::min(1., sum_); }

    void next()
    {
        sum_ += std::exp(logTerm_);
        logTerm_ += std::log((a_ + b_)/(b_ + 1.)) + logRest_;
        b_++;
    }

private:
    void beginWithStudent(double v, double logW)
    {
        const double z = (8.*v + 1.)/(8.*v + 3.)*std::sqrt(-v*logW);
        sum_ = std::erfc(z/std::sqrt(2.));
        // Gamma(a + 1/2)/Gamma(a), over Gamma(3/2)
        logTerm_ += 0.5*std::log(a_) + std::log1p(-1./(8.*a_) + 1./(128.*a_*a_)) - std::log(0.5*std::sqrt(CV_PI)) + 0.5*logRest_;
        b_ = 0.5;
    }

    double a_, b_ = 0., sum_ = 0., logTerm_, logRest_;
};

} // namespace

double upperTailF(int m, double v, double x) { return upperTailAnyF(2*m, v, x); }

double upperTailAnyF(int k, double v, double x) { return x > 0 ? TailsOfF(k, v, k*x).tail() : 1.; }

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
    const double CERTAIN = 1e7;                 // beyond what any x is a limit for
    if (!(x > 0) || (lambda > CERTAIN && k*x < 0.1*lambda))
        return 1.;
    // A Poisson mixture of central ones; from where it is largest, terms fall off fast to both sides.
    const int last = (int)(0.5*lambda + 10.*std::sqrt(0.5*lambda) + 30.);
    double sum = 0., logFactorial = 0.;         // std::lgamma would write to a variable that all threads share
    TailsOfF tails(k, v, k*x);
    for (int j = 0; j <= last; j++)
    {
        logFactorial += std::log(std::max(j, 1));
        const double logWeight = (lambda > 0 ? j*std::log(0.5*lambda) : j ? -HUGE_VAL : 0.) - 0.5*lambda - logFactorial;
        sum += std::exp(logWeight)*tails.tail();
        tails.next();
    }
    return std::min(1., sum);
}

} // namespace tools
