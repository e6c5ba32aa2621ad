// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CALIBRATION_INPUT_HPP
#define REFRACT_TOOLS_CALIBRATION_INPUT_HPP

#include "calibrate/starting_model.hpp"

namespace tools {

//! The input of a calibration, as the user gave it.
struct CalibrationInput
{
    RigData data;               //!< with its outliers
    RigOptions options;
    double square;
    std::vector<std::string> notices = {};      //!< of the checks before any fit
};

//! Of any camera.
bool hasPairs(const RigData& data);

//! The images of one camera, as a rig of its own.
CalibrationInput oneCamera(const CalibrationInput& input, int camera);

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
const double EXPLAINS_AS_WELL = 3.;         // times what the best of them leaves

//! Those that leave less than that, and are about as good as the best of them.
std::vector<Explanation> bestBelow(double most, const std::vector<Explanation>& tried);

//! Of mistakes in the order of what they leave free, those that leave less than any before.
std::vector<Explanation> withoutFreer(const std::vector<Explanation>& explaining);

} // namespace tools

#endif // REFRACT_TOOLS_CALIBRATION_INPUT_HPP
