// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MEASURED_CAUSES_HPP
#define REFRACT_TOOLS_MEASURED_CAUSES_HPP

#include "calibrate/calib_file.hpp"
#include "calibrate/rig_data.hpp"

namespace tools {

struct ViewObservations;

/** Why measured views contradict the calibration, as causesIn says it; empty if they do not, or if nothing tells. A few of the views are
taken. @param pixelSigma of a pixel coordinate */
std::string causesOf(const Calibration& calibration, const std::vector<View>& views, double pixelSigma);

/** The same of points of a scene, as far as images are not what they are given for, which no rig that is set free tells: its points follow
it. @param sigma of a usual pixel coordinate */
std::string mixupIn(const Calibration& calibration, const ViewObservations& scene, double sigma);

} // namespace tools

#endif // REFRACT_TOOLS_MEASURED_CAUSES_HPP
