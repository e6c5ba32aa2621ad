// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MATCH_NOISE_HPP
#define REFRACT_TOOLS_MATCH_NOISE_HPP

#include "match/match_choice.hpp"

/* How well features are placed. A large blob is placed less well than a small one:

    variance of a coordinate = floor^2 + (share scale)^2

Both numbers come from the residuals of the matches themselves, by maximum likelihood: they differ with texture, blur and light. */
namespace tools {

struct MatchResidual;

struct MatchNoise
{
    double floor = 0., share = 0.;

    double stdOf(double scale) const;
    double varianceOf(const MatchResidual& residual) const;     //!< of each of its numbers
};

//! What the residuals of one match tell: of n cameras 2 n - 3 numbers, as the rest of its pixels is the point's.
struct MatchResidual
{
    double squares, scale2;         //!< px^2; mean of the squared scales
    int count;                      //!< of the numbers; 0: there is no such point

    bool isWithin(const MatchNoise& noise) const;
};

std::vector<MatchResidual> residualsOf(const ScaledMatches& scaled, const RigModel& rig);

/** From the residuals of right matches and of some others, which are left out by the noise that the rest has. A right one is left out
with a probability of 1e-4. */
MatchNoise noiseOf(const std::vector<MatchResidual>& residuals);

} // namespace tools

#endif // REFRACT_TOOLS_MATCH_NOISE_HPP
