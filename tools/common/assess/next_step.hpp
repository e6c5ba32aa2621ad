// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_NEXT_STEP_HPP
#define REFRACT_TOOLS_NEXT_STEP_HPP

#include "assess/findings.hpp"

namespace tools {

//! What to do with the result: correct a value, take images, know a value better, or measure. Half a sentence.
std::string nextStep(const RigCalibration& calibration, const Assessment& assessment, const Findings& findings);

} // namespace tools

#endif // REFRACT_TOOLS_NEXT_STEP_HPP
