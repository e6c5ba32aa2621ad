// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MOMENTS_HPP
#define REFRACT_TOOLS_MOMENTS_HPP

#include "bundle/bundle_start.hpp"

namespace tools {

/** Throws Failure if the images of one camera are of later or earlier moments than those of the others: if rays meet far better after
some rows of the table. An adjustment to such matches creeps. Tables without images have no moments. */
void requireSameMoments(const BundleStart& start, const Matches& matches);

} // namespace tools

#endif // REFRACT_TOOLS_MOMENTS_HPP
