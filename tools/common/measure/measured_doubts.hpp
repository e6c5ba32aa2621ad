// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MEASURED_DOUBTS_HPP
#define REFRACT_TOOLS_MEASURED_DOUBTS_HPP

#include "measure/measured_views.hpp"
#include "measure/measurement.hpp"
#include <optional>

/* What speaks against measured points, in sentences; empty: nothing does. */
namespace tools {

//! Pixels that contradict each other by more than noise and calibration explain.
std::string contradictionIn(const std::vector<MeasuredView>& measured, const std::vector<Measurement>& results);

//! Points outside of their images.
std::string outsideImages(const Calibration& calibration, const std::vector<MeasuredView>& measured,
                          const std::vector<Measurement>& results);

bool mostContradict(const std::vector<Measurement>& results);

//! Lengths that are not the target's. @param plane that points were measured on; none: they were triangulated
std::string wrongLengths(double square, const Calibration& calibration, const std::vector<MeasuredView>& measured,
                         const std::vector<Measurement>& results, double pixelSigma, const std::optional<cv::Vec4d>& plane);

std::string noisierImages(const std::vector<MeasuredView>& measured, const std::vector<Measurement>& results, double pixelSigma);

} // namespace tools

#endif // REFRACT_TOOLS_MEASURED_DOUBTS_HPP
