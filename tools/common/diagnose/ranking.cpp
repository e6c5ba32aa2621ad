// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/ranking.hpp"
#include <algorithm>
#include <cmath>

namespace tools {

namespace {

const double VERY_STRONG = 10.;         // difference of two criteria
// Corners err a little together: two that remove nearly the same of a contradiction are as good.
const double AS_GOOD_SHARE = 0.05;
const double MORE_NOISE = 0.1;          // but leaves no more than this share beyond noise: of a gross contradiction 5 % is a lot

} // namespace

std::vector<Hypothesis> rank(const Hypothesis& asGiven, const std::vector<Hypothesis>& tried, int observations, double noise)
{
    double variance = asGiven.squares/observations;
    for (const Hypothesis& h : tried)
        variance = std::min(variance, h.squares/std::max(1, observations - h.parameters));
    variance = std::max(variance, noise*noise);
    if (!(variance > 0.) || !std::isfinite(variance))
        return {};
    const auto criterion = [&](const Hypothesis& h) { return h.squares/variance + h.parameters*std::log((double)observations); };
    std::vector<Hypothesis> ranked = tried;
    std::stable_sort(ranked.begin(), ranked.end(), [&](const Hypothesis& a, const Hypothesis& b) { return criterion(a) < criterion(b); });
    const double gained = ranked.empty() ? 0. : criterion(asGiven) - criterion(ranked[0]);
    if (!(gained > VERY_STRONG))
        return {};
    const double margin = std::isfinite(gained) ? std::max(VERY_STRONG, std::min(AS_GOOD_SHARE*gained, MORE_NOISE*observations))
                                                 : VERY_STRONG;
    // What is as good needs no more than to explain as much: the penalty of its parameters says which is simpler, not which is true. A
    // motion of all boards has six, a thickness one, and along the axis images do not tell one from the other.
    const double most = ranked[0].squares/variance + margin, leastGain = criterion(asGiven) - VERY_STRONG,
                 best = criterion(ranked[0]);
    const auto isMuchWorse = [&](const Hypothesis& h) {
        return !(criterion(h) <= best + margin) && !(h.squares/variance <= most && criterion(h) < leastGain); };
    ranked.erase(std::remove_if(ranked.begin() + 1, ranked.end(), isMuchWorse), ranked.end());
    return ranked;
}

} // namespace tools
