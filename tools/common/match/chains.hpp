// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHAINS_HPP
#define REFRACT_TOOLS_CHAINS_HPP

#include "match/partner_search.hpp"

/* Features of the images of one moment that are of one point: chains of pairs. A chain that has two places in one image contradicts
itself, and is none. */
namespace tools {

//! Per camera: which feature; -1: none.
using Chain = std::vector<int>;

struct PairMatches
{
    int first, second;              //!< cameras
    FeaturePairs pairs;
};

std::vector<Chain> chainsOf(const std::vector<Features>& features, const std::vector<PairMatches>& matches);

} // namespace tools

#endif // REFRACT_TOOLS_CHAINS_HPP
