// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PARTNER_SEARCH_HPP
#define REFRACT_TOOLS_PARTNER_SEARCH_HPP

#include "calibrate/rig_model.hpp"
#include "match/features.hpp"

/* Which features of two images are of one point. A window knows more than descriptors do: the partner is near the refracted epipolar
curve, within the depths of the scene. Only what is near is compared; a feature takes the one that is clearly the most alike, and is
taken only if that takes it, too. */
namespace tools {

//! Two cameras of a rig.
struct CameraPair
{
    int first, second;
    cv::Vec2d depth;                //!< z of the scene in the frame of the first
    double search;                  //!< px, from the curve

    //! @param depth in the frame of camera 1
    CameraPair(const RigModel& rig, int first, int second, const cv::Vec2d& depth, double search);
};

//! Indices of features of the first and the second image.
using FeaturePairs = std::vector<std::pair<int, int>>;

FeaturePairs partnersNearCurves(const RigModel& rig, const CameraPair& pair, const Features& first, const Features& second);

/* Features of the images of one moment that are of one point: chains of pairs. A chain that has two places in one image contradicts
itself, and is none. */

//! Per camera: which feature; -1: none.
using Chain = std::vector<int>;

struct PairMatches
{
    int first, second;              //!< cameras
    FeaturePairs pairs;
};

std::vector<Chain> chainsOf(const std::vector<Features>& features, const std::vector<PairMatches>& matches);

} // namespace tools

#endif // REFRACT_TOOLS_PARTNER_SEARCH_HPP
