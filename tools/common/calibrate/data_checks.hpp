// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DATA_CHECKS_HPP
#define REFRACT_TOOLS_DATA_CHECKS_HPP

#include "calibrate/rig_data.hpp"

/* Whether the images are what they are meant to be, before anything is fitted to them. */
namespace tools {

/** Direct and glass images belong together by their names. Throws Failure if both are there and no name is common, or if the
target was found in both images of no pair: the user meant pairs, and a calibration without them is far worse. */
void requirePairs(const RigImages& sets);

//! The same as far as the names of images tell, before any is searched for the target.
void requirePairNames(const RigSources& sources);

//! What spoils a calibration without showing in its residuals: one image under two names, boards that are all parallel.
std::vector<std::string> noticesOf(const RigImages& sets, const RigData& data);

} // namespace tools

#endif // REFRACT_TOOLS_DATA_CHECKS_HPP
