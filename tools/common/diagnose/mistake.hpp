// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MISTAKE_HPP
#define REFRACT_TOOLS_MISTAKE_HPP

#include "diagnose/calibration_input.hpp"

namespace tools {

//! What the images fit if a mistake is undone.
struct Explanation
{
    std::string sentence;
    double px;                  //!< median error of the fit, see medianErrorOfFit
};

//! A mistake in the input of a calibration, which may explain why the images do not fit.
struct Mistake
{
    bool (*appliesTo)(const CalibrationInput& input);           //!< whether this input can have it
    Explanation (*undo)(const CalibrationInput& input);         //!< undoes it and fits the same images again
};

} // namespace tools

#endif // REFRACT_TOOLS_MISTAKE_HPP
