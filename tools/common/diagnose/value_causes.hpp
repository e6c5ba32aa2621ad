// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_VALUE_CAUSES_HPP
#define REFRACT_TOOLS_VALUE_CAUSES_HPP

#include "diagnose/fitted_rig.hpp"

/* Causes of a contradiction that are a value which was given of windows. */
namespace tools {

//! Thickness, index, distance, radius, medium: all windows together, as one option gives them; and each alone.
void addValues(const FittedRig& rig, std::vector<Cause>& causes);

//! What is known of where a flat window is: its normal, and its distance if markers tell it.
void addKnownPlaces(const FittedRig& rig, std::vector<Cause>& causes);

//! The faces of all layers of one window; images tell the sum, which the first layer stands for.
void addWedges(const FittedRig& rig, std::vector<Cause>& causes);

//! The curvature of a window that is taken to be flat within --bow-std.
void addBows(const FittedRig& rig, std::vector<Cause>& causes);

} // namespace tools

#endif // REFRACT_TOOLS_VALUE_CAUSES_HPP
