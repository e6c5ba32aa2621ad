// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_TARGET_MISTAKES_HPP
#define REFRACT_TOOLS_TARGET_MISTAKES_HPP

#include "diagnose/calibration_input.hpp"

/* A target that is not as given, found without a fit through the window. Each returns a sentence; empty: no such mistake. */
namespace tools {

/** The detector finds a part of the board in place of the board, and not the same part in each image.
@param fewest views, above 0, that show it: of one alone the board may have moved by about a square */
std::string partOfBoard(const CalibrationInput& input, size_t fewest);

//! px RMS that a lens leaves of a camera's direct images; 0: there are none, or they are not asked for the lens.
double errorOfDirect(const CalibrationInput& input, int camera);

//! Corners in the direct images that no lens explains.
std::string badCorners(const CalibrationInput& input);

} // namespace tools

#endif // REFRACT_TOOLS_TARGET_MISTAKES_HPP
