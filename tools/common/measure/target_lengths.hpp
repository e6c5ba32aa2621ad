// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_TARGET_LENGTHS_HPP
#define REFRACT_TOOLS_TARGET_LENGTHS_HPP

#include "calibrate/rig_data.hpp"

namespace tools {

//! Distances between neighbouring points, measured minus true.
std::vector<double> lengthErrors(const View& view, const std::vector<cv::Point3d>& points);

} // namespace tools

#endif // REFRACT_TOOLS_TARGET_LENGTHS_HPP
