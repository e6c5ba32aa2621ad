// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_STEREO_TABLE_HPP
#define REFRACT_TOOLS_STEREO_TABLE_HPP

#include "stereo/rectified_rig.hpp"
#include <string>
#include <vector>

namespace tools {

//! What the table says of a pair.
struct PairResult
{
    std::string stem;
    double matched = 0, near = 0, far = 0, typicalSigma = NAN, rowsFound = NAN, rowsExpected = NAN, seconds = 0;
    std::vector<std::string> warnings;
    std::string refusal;                //!< empty: it is written
};

//! A row for each pair, or one for all where these are too many to read.
void printTable(const std::vector<PairResult>& results, const RectifiedRig& rig);

} // namespace tools

#endif // REFRACT_TOOLS_STEREO_TABLE_HPP
