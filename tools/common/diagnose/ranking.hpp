// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RANKING_HPP
#define REFRACT_TOOLS_RANKING_HPP

#include <string>
#include <vector>

/* Which of several hypotheses explains observations that contradict a calibration. Each gives up one assumption and is fitted to the
same observations. They are compared by Schwarz's criterion (BIC; Annals of Statistics 6, 1978)

    chi^2 / sigma^2 + k log(n)

of n observations and k parameters set free, where sigma is the noise that the best of them leaves. */
namespace tools {

struct Hypothesis
{
    std::string sentence;       //!< the cause, with its value and +-
    double squares;             //!< sum of squares, px^2, of the residuals and of what priors add; infinity: no fit
    int parameters;             //!< set free, beside those of the fit as given
};

/** The hypotheses that explain the observations, the best first; others only if they explain about as much. Empty if none is clearly
better than nothing wrong (a difference of 10, "very strong evidence" of Kass and Raftery, JASA 90, 1995).
@param asGiven the fit with nothing given up. @param observations their number (two a point)
@param noise px, the least standard deviation that a coordinate of these observations can have; 0: not known */
std::vector<Hypothesis> rank(const Hypothesis& asGiven, const std::vector<Hypothesis>& tried, int observations, double noise);

} // namespace tools

#endif // REFRACT_TOOLS_RANKING_HPP
