// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MATCH_NOISE_HPP
#define REFRACT_TOOLS_MATCH_NOISE_HPP

#include "bundle/bundle_adjustment.hpp"

/* How well features are placed. A large blob is placed less well than a small one:

    variance of a coordinate = floor^2 + (share scale)^2

Both numbers come from the residuals of the matches themselves, by maximum likelihood: they differ with texture, blur and light. */
namespace tools {

struct MatchNoise
{
    double floor = 0., share = 0.;

    double stdOf(double scale) const;
};

/** From the matches that a fit used. @param scales per camera, per point, as Matches::pixels
A match of n cameras tells 2 n - 3 numbers: the rest of its pixels is the point's. */
MatchNoise noiseOfMatches(const Matches& matches, const std::vector<std::vector<double>>& scales, const BundleAdjustment& fit);

} // namespace tools

#endif // REFRACT_TOOLS_MATCH_NOISE_HPP
