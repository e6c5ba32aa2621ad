// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_VALUE_MISTAKES_HPP
#define REFRACT_TOOLS_VALUE_MISTAKES_HPP

#include "diagnose/calibration_input.hpp"

/* Wrong given values. Each function sets one free, or to another likely value, and fits the same images again. */
namespace tools {

//! As the user typed it: "1.5437" with so many digits, or "water:T=12 (1.33415)".
std::string typedIndex(const GivenIndex& index, int digits);

//! Square or thickness: pairs determine only the ratio of the two.
Explanation wrongScale(const CalibrationInput& input);

//! Coordinates of points in another unit than the window, without pairs, which would determine the thickness.
Explanation wrongUnitOfPoints(const CalibrationInput& input);

Explanation wrongIndex(const CalibrationInput& input);

//! Water taken for air, or air for water.
Explanation wrongMedium(const CalibrationInput& input);

/** The same of a sealed rig, by each camera alone: that is quick, and no place between cameras in a wrong medium is searched for. NO_FIT
unless the other medium leaves each camera that can tell no more than noise, and far less than the given one.
@param clean px, of noise */
Explanation wrongMediumOfEach(const CalibrationInput& input, double clean);

//! A dome taken for a pane, or a pane for a dome; the radius is estimated.
Explanation wrongShape(const CalibrationInput& input);

//! Of a lens from a file: in another unit, with a decimal point elsewhere, or of quite another lens.
Explanation wrongFocalLength(const CalibrationInput& input);

//! Cameras that were said to share a window have one each.
Explanation separateWindows(const CalibrationInput& input);

//! One window for all cameras that look the same way, of a rig whose windows are not said to be shared.
Explanation sharedWindows(const CalibrationInput& input);

} // namespace tools

#endif // REFRACT_TOOLS_VALUE_MISTAKES_HPP
