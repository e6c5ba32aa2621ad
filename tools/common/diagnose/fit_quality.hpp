// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FIT_QUALITY_HPP
#define REFRACT_TOOLS_FIT_QUALITY_HPP

#include "calibrate/fit.hpp"
#include "calibrate/starting_model.hpp"
#include <limits>

/* How well a calibration fits its images. If it does not, something in the input is wrong. */
namespace tools {

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

} // namespace tools

#endif // REFRACT_TOOLS_FIT_QUALITY_HPP
