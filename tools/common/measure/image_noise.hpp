// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_IMAGE_NOISE_HPP
#define REFRACT_TOOLS_IMAGE_NOISE_HPP

#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"

namespace tools {

//! The noise of a pixel coordinate.
struct ImageNoise
{
    double sigma, dof;          //!< dof 0: nothing tells
};

/** What the images themselves tell of their noise, whatever the calibration is worth: each image has a pose of its own, and a
wrong lens, window or target leaves residuals that are smooth over the image, so that a cubic polynomial takes them away. */
ImageNoise imageNoise(const RigModel& rig, const std::vector<View>& views);

} // namespace tools

#endif // REFRACT_TOOLS_IMAGE_NOISE_HPP
