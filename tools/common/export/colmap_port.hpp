// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_COLMAP_PORT_HPP
#define REFRACT_TOOLS_COLMAP_PORT_HPP

#include "colmap/colmap_model.hpp"
#include <opencv2/refract.hpp>

namespace tools {

/* A camera behind a window as Calibmar and COLMAP's fork for cameras under water have it, exactly; makePort() reads it again. */

//! FLATPORT (normal, distance) or DOMEPORT (centre, radius), then thickness and the indices inside, of the port, outside.
struct ColmapPort
{
    std::string model;                  //!< empty: there is no window
    std::vector<double> parameters;
};

/** Throws Failure for a window, or a lens, that they have none like.
@param name of the camera @param program that is told */
ColmapPort colmapPortOf(const cv::refract::GlassWindow& window, const std::string& name, const std::string& program);
ColmapCamera exactColmapCamera(const cv::refract::RefractiveCamera& camera, uint32_t id, const std::string& name,
                               const std::string& program);

} // namespace tools

#endif // REFRACT_TOOLS_COLMAP_PORT_HPP
