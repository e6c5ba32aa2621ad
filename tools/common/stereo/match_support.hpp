// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MATCH_SUPPORT_HPP
#define REFRACT_TOOLS_MATCH_SUPPORT_HPP

#include "stereo/dense_stereo.hpp"

/* A matcher fills a flat wall with what its neighbours have, and finds a best partner for noise too. What a match rests on is
seen afterwards: the two patches must have a texture, and the same. */
namespace tools {

/** Matched pixels of rectified1 whose patch correlates with its partner's; what flat areas and chance give does not.
@param vertical disparity runs along columns */
int supportedMatches(const DenseStereo& stereo, bool vertical);

} // namespace tools

#endif // REFRACT_TOOLS_MATCH_SUPPORT_HPP
