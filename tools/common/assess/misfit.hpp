// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MISFIT_HPP
#define REFRACT_TOOLS_MISFIT_HPP

#include "assess/given.hpp"
#include "assess/rig_calibration.hpp"

/* A calibration that cannot be right: its corners lie farther from where it puts them than corners are ever wrong, or all
pairs contradict it. Something given is wrong then, and what it is can often be told: the likely mistakes are undone in turn,
and the same images are fitted again. */
namespace tools {

//! Mistakes that explain images which do not fit, the likely ones first; empty if none of those that are known does.
std::vector<std::string> explainMisfit(const Given& given);

//! Throws Failure with the explanations if a calibration cannot be right. @param c with fit, residuals and baselines
void requireSensible(const RigCalibration& c, const Given& given);

//! What the library says, in the words of the tool, with the explanations.
std::string explainError(const std::string& error, const Given& given);

} // namespace tools

#endif // REFRACT_TOOLS_MISFIT_HPP
