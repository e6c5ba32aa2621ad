// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FEW_POINTS_HPP
#define REFRACT_TOOLS_FEW_POINTS_HPP

#include "calibrate/outliers.hpp"

/* Images that have no pose: they show too few points of the target, or points on one line. */
namespace tools {

/** Removes them from the sets.
@param target null: all points have coordinates of their own
@return what was removed; images without any point are not listed
Throws Failure where nothing would be left of a camera's direct images, or of those through the window. */
std::vector<Rejected> leaveOutFewPoints(const Target* target, RigImages& sets);

} // namespace tools

#endif // REFRACT_TOOLS_FEW_POINTS_HPP
