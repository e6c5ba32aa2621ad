// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FIT_QUALITY_HPP
#define REFRACT_TOOLS_FIT_QUALITY_HPP

#include "calibrate/fit.hpp"
#include "calibrate/starting_model.hpp"
#include <limits>

/* Whether a calibration explains its images, or something given must be wrong. */
namespace tools {

const double NO_FIT = std::numeric_limits<double>::infinity();

//! 0 of none.
double median(std::vector<double> values);

/** How far half of the corners lie from where the fit puts them, px: wrong corners among them do not matter. Of the worse
camera, and of the moments with a glass image: direct images alone always fit. */
double medianCornerError(const RigData& data, const std::vector<Residual>& residuals);

//! Half of the corners are never farther off where nothing is wrong, px.
double largestSoundError(const RigData& data);

//! medianCornerError of a fit to all the data, NO_FIT if there is none. @param result gets the rig that was fitted
double medianErrorOfFit(const RigData& data, const RigOptions& options, RigModel* result = nullptr);

} // namespace tools

#endif // REFRACT_TOOLS_FIT_QUALITY_HPP
