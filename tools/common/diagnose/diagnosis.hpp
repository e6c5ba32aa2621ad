// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DIAGNOSIS_HPP
#define REFRACT_TOOLS_DIAGNOSIS_HPP

#include "calibrate/fit.hpp"
#include "diagnose/calibration_input.hpp"
#include "diagnose/image_mixups.hpp"
#include "diagnose/plain_fit.hpp"

/* A calibration that cannot be right: its residuals are larger than detection errors are, or all pairs contradict it. Then something
in the input is wrong. Often a test finds it: the likely mistakes are undone one after the other, and the same images are fitted
again. */
namespace tools {

//! The mistakes that explain images which do not fit, the likely ones first; empty if no known mistake does.
std::vector<std::string> diagnose(const CalibrationInput& input);
//! @param imagesToo also mix-ups of images, which requireNoMixUp may have looked for
std::vector<std::string> diagnose(const CalibrationInput& input, const MixUps& mixUps, const PlainFit& plain, bool imagesToo);

/** Throws Failure with the explanations if a calibration cannot be right.
@param data what is left without outliers. @param residuals of the fit to them
@param rmsOfSeparateFits px, of fits of each camera by itself */
void requirePlausible(const RigData& data, const std::vector<Residual>& residuals, double rmsOfSeparateFits,
                      const CalibrationInput& input);

/** Throws Failure if images are mixed up: turned, mirrored, exchanged, of another moment. A fit to such images creeps, so that they are
looked at before any that is not short.
@param only gets the rig of the fit that it made, if that met the only minimum
@return whether it has looked for all of them */
bool requireNoMixUp(const CalibrationInput& input, const MixUps& mixUps, std::optional<RigModel>& only);

/** Whether a fit to all images leaves far more than the lens's own images do, or than one with another medium behind the windows: a
mistake may explain it, be it below a pixel.
@param plain gets what another medium does */
bool isSuspicious(const CalibrationInput& input, PlainFit& plain);

/** Whether a fit to all images is near enough for one without wrong points to be looked for: half of the corners are where detectors find
them, and not far more off than the lens's own images leave them. */
bool isSound(const CalibrationInput& input, const PlainFit& plain, bool suspicious);

//! Throws Failure if a mistake explains why the images fit no better.
void requireNoCause(const CalibrationInput& input, const MixUps& mixUps, const PlainFit& plain, bool imagesToo);

//! Throws Failure: requireNoCause found nothing, and without outliers the images fit no better.
[[noreturn]] void refuseUnexplained(const CalibrationInput& input, const PlainFit& plain);

//! An error of a calibration, with the explanations.
std::string explainError(const std::string& error, const CalibrationInput& input);

//! The same of what fitImages threw, with what to do where the fit did not converge.
std::string explainError(const cv::refract::CalibrationError& error, const CalibrationInput& input);

} // namespace tools

#endif // REFRACT_TOOLS_DIAGNOSIS_HPP
