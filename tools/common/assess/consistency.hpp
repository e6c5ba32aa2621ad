// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CONSISTENCY_HPP
#define REFRACT_TOOLS_CONSISTENCY_HPP

#include "assess/measurement.hpp"

/* Whether what was measured can be: pixels that no point, or no pose of the target, explains. */
namespace tools {

/** Judges how well the two pixels of each point agree. Of the four coordinates three make the point; the fourth, which is
about the distance of the partner from its epipolar curve over sqrt(2), is left over and must be small against the noise and
the calibration's covariance. Where it is not, sigma gets the misfit; beyond a few standard deviations the status becomes
INCONSISTENT, and far beyond (20 of them, and 2 px at least) the point NaN. */
void judgePartners(const Calibration& calibration, double pixelSigma, Measurement& measurement);

//! The same of a target's pose: one that leaves large residuals makes all its points INCONSISTENT and their sigma NaN.
void judgePose(double pixelSigma, Measurement& measurement);

} // namespace tools

#endif // REFRACT_TOOLS_CONSISTENCY_HPP
