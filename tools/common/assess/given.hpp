// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_GIVEN_HPP
#define REFRACT_TOOLS_GIVEN_HPP

#include "calibrate/starting_model.hpp"

namespace tools {

//! What went into a calibration, as the user gave it.
struct Given
{
    RigData data;               //!< all of it, wrong points too
    RigOptions options;
    double square;
    std::vector<std::string> notices = {};      //!< what was noticed before any fit
};

//! Of any camera.
bool hasPairs(const RigData& data);

//! What one camera saw, as a rig of its own.
Given oneCamera(const Given& given, int camera);

} // namespace tools

#endif // REFRACT_TOOLS_GIVEN_HPP
