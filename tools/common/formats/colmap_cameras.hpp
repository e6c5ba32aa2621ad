// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_COLMAP_CAMERAS_HPP
#define REFRACT_TOOLS_COLMAP_CAMERAS_HPP

#include <opencv2/refract.hpp>
#include <string>
#include <vector>

namespace tools {

const double COLMAP_CORNER = 0.5;       //!< its pixel (0, 0) is a corner of the image; this is the centre of the first pixel

/** By COLMAP's name of a lens model, with its pixels. Throws Failure for a model that is not known here, and for one that
has no equal in OpenCV. @param name empty: by id */
cv::Ptr<cv::refract::RefractiveCamera> makeColmapCamera(const std::string& name, const std::vector<double>& parameters,
                                                        const cv::Size& size);

//! By the ids of its binary files.
std::vector<std::string> colmapModels();
size_t colmapParameterCount(const std::string& model);

/** COLMAP's FLATPORT (normal, distance, thickness, indices of air, port and water) and DOMEPORT (centre, radius, the same), as its fork
for cameras under water and Calibmar have them. Throws Failure. */
cv::refract::GlassWindow makePort(const std::string& type, const std::vector<double>& parameters);

} // namespace tools

#endif // REFRACT_TOOLS_COLMAP_CAMERAS_HPP
