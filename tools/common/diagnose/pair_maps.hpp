// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PAIR_MAPS_HPP
#define REFRACT_TOOLS_PAIR_MAPS_HPP

#include "calibrate/rig_data.hpp"

/* Pairs of images against the map of the direct image on that through the window, which a window nearly is: a homography. */
namespace tools {

//! How far pairs are from one map of the direct image on that through the window, of the worst camera. A window is such a map, nearly.
double pairsFromOneMap(const RigData& data);

//! Views of which the pair of a camera is off the map that most of its pairs are on; empty: none, or no map is that of most.
std::vector<int> pairsOffMap(const RigData& data, int camera);

/** Views whose pairs of a camera are on two maps, as of two cameras, whatever their names are: those of either; empty: one map is as
good, or two are not enough. */
std::vector<std::vector<int>> pairsOfTwoMaps(const RigData& data, int camera);

} // namespace tools

#endif // REFRACT_TOOLS_PAIR_MAPS_HPP
