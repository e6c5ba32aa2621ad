// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PLAIN_FIT_HPP
#define REFRACT_TOOLS_PLAIN_FIT_HPP

#include "calibrate/fit.hpp"
#include "calibrate/starting_model.hpp"
#include "diagnose/calibration_input.hpp"
#include "diagnose/hypothesis_tests.hpp"
#include <limits>
#include <optional>

namespace tools {

/* How well a calibration fits its images. If it does not, something in the input is wrong. */

const double NO_FIT = std::numeric_limits<double>::infinity();

/** The median length of the residuals, px, which outliers hardly change: that of the worst camera, over the views with a glass image,
as direct images alone always fit. */
double medianCornerError(const RigData& data, const std::vector<Residual>& residuals);

//! The largest median error of correct input, px.
double largestSoundError(const RigData& data);

//! All values of windows and boards as exact; faces are parallel then, and panes flat.
RigOptions exactly(RigOptions options);

//! medianCornerError of a fit to all the data, NO_FIT if there is none soon. @param result gets that fit
double medianErrorOfFit(const RigData& data, const RigOptions& options, Fit* result = nullptr);

/* A calibration before it is fitted: where causes are looked for if the library has no fit of the images, as pairs that contradict each
other by pixels. A fit that was forced through these ends far from the truth; the start does not know of the contradiction. */

//! A fit of all images to what is given, without a search for wrong points: a wrong value makes many good points look wrong.
struct PlainFit
{
    double px = NO_FIT;                         //!< medianCornerError
    bool isUndetermined = false;                //!< images that fit do not tell all numbers
    double noise = 0.;                          //!< px, what smooth maps leave of each image (imageNoise); 0: not known
    std::optional<Contradiction> explained;     //!< a cause that explains all of its residuals
    std::optional<RigModel> only;               //!< the rig, if the search met no other minimum: later fits start there
    std::optional<Explanation> otherMedium;     //!< wrongMedium, once it was tried
};

//! px, what smooth maps leave of each image before any fit (imageNoise); 0: not known
double noiseOfImages(const CalibrationInput& input);

//! @param found where an earlier fit, with what is given as exact, met the only minimum
PlainFit fitPlainly(const CalibrationInput& input, const std::optional<RigModel>& found = std::nullopt);

} // namespace tools

#endif // REFRACT_TOOLS_PLAIN_FIT_HPP
