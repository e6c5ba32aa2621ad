// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_GIVEN_VALUES_HPP
#define REFRACT_TOOLS_GIVEN_VALUES_HPP

#include "report/summary.hpp"

namespace tools {

/** What was given and not left to the images alone: each value, how well it is known, and who said so. Cells: value, one standard
deviation, source. */
std::vector<SummaryRow> givenRows(const RigCalibration& calibration);

} // namespace tools

#endif // REFRACT_TOOLS_GIVEN_VALUES_HPP
