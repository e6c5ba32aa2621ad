// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MEASURING_LINES_HPP
#define REFRACT_TOOLS_MEASURING_LINES_HPP

#include "accept/acceptance.hpp"

/* What VDI/VDE 2634 part 1 asks of the lengths that test an optical system: seven measuring lines anywhere in the volume, five
lengths on each, the longest at least two thirds of the volume's longest diagonal. */
namespace tools {

//! Lengths on one straight line, as indices.
using MeasuringLine = std::vector<size_t>;

/** Lines are inferred from where lengths were measured: from the longest on, a length is on a line if it is along it, within a tenth
of its own length, and both of its ends are within a twentieth of the line's longest length from it. */
std::vector<MeasuringLine> measuringLines(const Acceptance& acceptance);

//! What the test lacks, half a sentence each; empty: nothing.
std::vector<std::string> missingOf(const Acceptance& acceptance);

} // namespace tools

#endif // REFRACT_TOOLS_MEASURING_LINES_HPP
