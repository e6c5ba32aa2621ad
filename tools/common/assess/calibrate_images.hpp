// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CALIBRATE_IMAGES_HPP
#define REFRACT_TOOLS_CALIBRATE_IMAGES_HPP

#include "assess/rig_calibration.hpp"
#include "console/failure.hpp"
#include <functional>

namespace tools {

//! The images fit a rational lens, but do not tell its coefficients: choose, and leave open, no more than a polynomial's.
class LensUndetermined : public Failure
{
public:
    using Failure::Failure;
};

/** Lens and start, wrong points, the fit, and what a user would do instead. Throws Failure with the likely causes where the images do
not fit what is given.
@param calibration in: data, options, square, notices; the rest is result, and of the data outliers are removed
@param robust without wrong points and images
@param step after each third of the work */
void calibrateImages(RigCalibration& calibration, bool robust, const std::function<void()>& step);

} // namespace tools

#endif // REFRACT_TOOLS_CALIBRATE_IMAGES_HPP
