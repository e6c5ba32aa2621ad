// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/chi_squared.hpp"
#include <algorithm>
#include <cmath>

namespace tools {

double upperTailChiSquared(int dof, double x)
{
    if (!(x > 0.))
        return 1.;
    // exp(-x/2) times the sum of (x/2)^a / Gamma(a + 1) for a = 0, 1, ... below dof/2; of odd dof a = 1/2, 3/2, ... and erfc.
    const double half = 0.5*x;
    const bool odd = dof % 2 != 0;
    double sum = odd ? std::erfc(std::sqrt(half)) : 0.;
    double logTerm = odd ? 0.5*std::log(half) - 0.5*std::log(0.25*std::acos(-1.)) : 0.;     // Gamma(3/2) = sqrt(pi)/2
    for (double a = odd ? 0.5 : 0.; a < 0.5*dof - 0.25; a += 1.)
    {
        sum += std::exp(logTerm - half);
        logTerm += std::log(half/(a + 1.));
    }
    return std::min(1., sum);
}

} // namespace tools
