// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/student_t.hpp"
#include <opencv2/core/cvdef.h>
#include <cmath>
#include <limits>

namespace tools {

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
