// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_UNFITTED_HPP
#define REFRACT_TOOLS_UNFITTED_HPP

#include "calibrate/fit.hpp"
#include "calibrate/starting_model.hpp"

/* A calibration before it is fitted: where causes are looked for if the library has no fit of the images, as pairs that contradict each
other by pixels. A fit that was forced through these ends far from the truth; the start does not know of the contradiction. */
namespace tools {

/** Lenses, places and windows of a start, each board where its first image has it, and deviations of 1 for what a fit would estimate.
@param start of startModel. @param flags GlassCalibrationFlags */
Fit unfitted(const RigData& data, const RigModel& start, const std::vector<LensSource>& lensSources, int flags);

} // namespace tools

#endif // REFRACT_TOOLS_UNFITTED_HPP
