// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MIXED_UP_IMAGES_HPP
#define REFRACT_TOOLS_MIXED_UP_IMAGES_HPP

#include "assess/explanation.hpp"
#include "assess/given.hpp"

/* Images that are not what they are given for: each mix-up is undone, and the same images are fitted again. */
namespace tools {

//! Those of all cameras.
Explanation directAndGlassExchanged(const Given& given);

//! Those of the one camera of several that explains most.
Explanation directAndGlassExchangedOfOne(const Given& given);

/** The folders of two cameras exchanged, in one state only. Without a known lens the cameras have no names of their own:
the glass images exchanged back explain exchanged direct images as well. */
Explanation camerasExchanged(const Given& given, bool glass);

//! Equal names of different cameras are not the same moment.
Explanation otherMoments(const Given& given);

//! Equal names of a direct and a glass image are not one place of the board.
Explanation unpaired(const Given& given);

/** Points of files: one axis turned round or two exchanged, v counted from below, or the same of one camera's file. All that
makes is a mirror image, which a flat target cannot tell unless only one camera has it. */
Explanation mirrored(const Given& given);

} // namespace tools

#endif // REFRACT_TOOLS_MIXED_UP_IMAGES_HPP
