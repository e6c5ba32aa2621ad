// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FEW_POINTS_HPP
#define REFRACT_TOOLS_FEW_POINTS_HPP

#include "calibrate/wrong_points.hpp"

/* Views of which no pose can be found, as they show too few points of the target, or points on one line. */
namespace tools {

/** Takes them out of the sets.
@param target null: all points have coordinates of their own
@return what was taken out; a view of which nothing was seen is not worth a word
Throws Failure where nothing would be left of a camera's direct images, or of those through the window. */
std::vector<Dropped> leaveOutFewPoints(const Target* target, RigViewSets& sets);

} // namespace tools

#endif // REFRACT_TOOLS_FEW_POINTS_HPP
