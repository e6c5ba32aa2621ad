// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MATCH_CHOICE_HPP
#define REFRACT_TOOLS_MATCH_CHOICE_HPP

#include "bundle/matches.hpp"
#include "calibrate/rig_model.hpp"

/* Matches, and which of them to take. */
namespace tools {

struct ScaledMatches
{
    Matches matches;
    std::vector<std::vector<double>> scales;        //!< of the features, per camera, per point
    //! Per point: distance of its features' descriptors over the usual one; empty: all are alike.
    std::vector<double> unlike = {};

    int size() const { return (int)matches.names.size(); }
    void add(const ScaledMatches& others);
    ScaledMatches only(const std::vector<int>& points) const;
};

//! Which matches are at the same place at another moment, too: these stand still, or are reflections.
std::vector<uchar> recurring(const ScaledMatches& all);

/** So many at most, spread over the image and over depth, as a corner of an image knows more than its middle; in each cell the smallest
features first, as they are placed best. What was taken already, be it at another moment, is not taken again: a detail of a scene that
stands still tells no more the second time.
@param rig that measures the depths */
std::vector<int> spreadChoice(const ScaledMatches& all, const RigModel& rig, int count);

} // namespace tools

#endif // REFRACT_TOOLS_MATCH_CHOICE_HPP
