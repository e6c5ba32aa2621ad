// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SCENE_CHECK_HPP
#define REFRACT_TOOLS_SCENE_CHECK_HPP

#include "bundle/matches.hpp"
#include "calibrate/rig_model.hpp"
#include "measure/view_observations.hpp"

namespace tools {

//! Matches as a check of a rig takes them, with points where the rig as calibrated sees them; without matches of which it sees none.
ViewObservations observationsOf(const RigModel& rig, const Matches& matches);

} // namespace tools

#endif // REFRACT_TOOLS_SCENE_CHECK_HPP
