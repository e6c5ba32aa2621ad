// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MATCH_SUPPORT_HPP
#define REFRACT_TOOLS_MATCH_SUPPORT_HPP

#include "stereo/dense_stereo.hpp"

/* A matcher fills areas without texture from their neighbours, and finds a best match for noise too. Afterwards the two patches of a
match are compared: both must have texture, and the same. */
namespace tools {

/** The number of matched pixels of rectified1 whose patch correlates with that of the match; in flat areas and by chance it does not.
@param vertical disparity runs along columns */
int supportedMatches(const DenseStereo& stereo, bool vertical);

} // namespace tools

#endif // REFRACT_TOOLS_MATCH_SUPPORT_HPP
