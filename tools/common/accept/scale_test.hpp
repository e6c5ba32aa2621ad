// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SCALE_TEST_HPP
#define REFRACT_TOOLS_SCALE_TEST_HPP

#include "accept/lengths.hpp"

namespace tools {

/** Whether the lengths are those of a board with the square that calibrated, as far as their certificates tell: between its points there
is nothing but sqrt(a^2 + b^2) squares. If it is that board, a wrong square makes both sides wrong alike, and the test does not see it.
@param lengths as certified @param square of the calibration; 0: not known */
bool areOfBoard(const std::vector<CalibratedLength>& lengths, double square);

} // namespace tools

#endif // REFRACT_TOOLS_SCALE_TEST_HPP
