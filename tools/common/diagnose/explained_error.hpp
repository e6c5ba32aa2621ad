// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_EXPLAINED_ERROR_HPP
#define REFRACT_TOOLS_EXPLAINED_ERROR_HPP

#include "diagnose/calibration_input.hpp"

namespace tools {

//! An error of a calibration, with the explanations.
std::string explainError(const std::string& error, const CalibrationInput& input);

//! The same of what fitImages threw, with what to do where the fit did not converge.
std::string explainError(const cv::refract::CalibrationError& error, const CalibrationInput& input);

} // namespace tools

#endif // REFRACT_TOOLS_EXPLAINED_ERROR_HPP
