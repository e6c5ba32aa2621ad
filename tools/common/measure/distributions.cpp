// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/distributions.hpp"
#include <opencv2/core/cvdef.h>
#include <algorithm>
#include <cmath>
#include <limits>

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

//! Beyond 25 by its asymptotic series (Abramowitz and Stegun, 7.1.23), to 1e-10; erfc itself is zero beyond 27.
double logErfc(double x)
{
    if (x < 25.)
        return std::log(std::erfc(x));
    const double square = x*x;
    return -square - std::log(x*std::sqrt(CV_PI)) + std::log1p((-1./2. + (3./4. - 15./8./square)/square)/square);
}

} // namespace

double upperTailChiSquared(int dof, double x) { return std::exp(logUpperTailChiSquared(dof, x)); }

double logUpperTailChiSquared(int dof, double x)
{
    if (!(x > 0.))
        return 0.;
    if (std::isinf(x))
        return -HUGE_VAL;
    // exp(-x/2) times the sum of (x/2)^a / Gamma(a + 1) for a = 0, 1, ... below dof/2; of odd dof a = 1/2, 3/2, ... and erfc.
    const double half = 0.5*x;
    const bool odd = dof % 2 != 0;
    double logSum = odd ? logErfc(std::sqrt(half)) : -HUGE_VAL;
    double logTerm = (odd ? 0.5*std::log(half) - std::log(0.5*std::sqrt(CV_PI)) : 0.) - half;     // Gamma(3/2) = sqrt(pi)/2
    for (double a = odd ? 0.5 : 0.; a < 0.5*dof - 0.25; a += 1.)
    {
        logSum = std::max(logSum, logTerm) + std::log1p(std::exp(-std::fabs(logSum - logTerm)));
        logTerm += std::log(half/(a + 1.));
    }
    return std::min(0., logSum);
}

double zScoreOfChiSquared(int dof, double x)
{
    double low = 0., high = std::sqrt(std::max(0., x));
    if (dof == 1 || !std::isfinite(x))
        return high;
    const double logTail = logUpperTailChiSquared(dof, x);
    for (int i = 0; i < 60; i++)
        (logUpperTailChiSquared(1, 0.25*(low + high)*(low + high)) > logTail ? low : high) = 0.5*(low + high);
    return low;
}

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

static const double MANY = 1e5;         // degrees of freedom that no one tells from the normal law

/* A finite sum of powers of the cosine of theta = atan(x/sqrt(v)) (Abramowitz and Stegun, 26.7.3 and 26.7.4):
    v odd:   2/pi (theta + sin (cos + 2/3 cos^3 + 2*4/(3*5) cos^5 + ... up to cos^(v-2)))
    v even:  sin (1 + 1/2 cos^2 + 1*3/(2*4) cos^4 + ... up to cos^(v-2)) */
double withinStudentT(double x, double dof)
{
    if (!(dof < MANY))
        return std::erf(x/std::sqrt(2.));
    const int v = (int)dof;
    const double theta = std::atan(x/std::sqrt((double)v)), cosine = std::cos(theta);
    const bool odd = v % 2 == 1;
    double term = odd ? cosine : 1., sum = 0.;
    for (int power = odd ? 1 : 0; power <= v - 2; power += 2)
    {
        sum += term;
        term *= (power + 1.)/(power + 2.)*cosine*cosine;
    }
    return odd ? 2./CV_PI*(theta + std::sin(theta)*sum) : std::sin(theta)*sum;
}

//! Of |t|, half.
static double density(double x, double dof)
{
    if (!(dof < MANY))
        return std::exp(-0.5*x*x)/std::sqrt(2.*CV_PI);
    const double v = std::floor(dof);
    return std::exp(std::lgamma(0.5*(v + 1.)) - std::lgamma(0.5*v) - 0.5*(v + 1.)*std::log1p(x*x/v))/std::sqrt(v*CV_PI);
}

double coverageFactor(double dof, double coverage)
{
    if (!(dof >= 1.))
        return std::numeric_limits<double>::infinity();
    // Newton's steps from 0 never pass the solution, as the density falls.
    const int MOST_STEPS = 200;
    double k = 0.;
    for (int i = 0; i < MOST_STEPS; i++)
    {
        const double step = (coverage - withinStudentT(k, dof))/(2.*density(k, dof));
        k += step;
        if (!(step > 1e-14*k))
            break;
    }
    return k;
}

double effectiveDof(double total, double part, double dof)
{
    return part > 0 ? dof*(total/part)*(total/part) : std::numeric_limits<double>::infinity();
}

} // namespace tools
