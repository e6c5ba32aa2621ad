// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/central_rig.hpp"

#include <opencv2/core.hpp>

namespace tools {

std::string errorText(const CentralRig& rig, const ExportedCamera& camera)
{
    const CentralError& e = camera.central.error;
    const std::string unit = rig.unit.empty() ? "" : " " + rig.unit;
    return cv::format("rms %.3g px, max %.3g px; as length rms %.3g%s, max %.3g%s", e.rms, e.max, e.lengthRms, unit.c_str(),
                      e.lengthMax, unit.c_str());
}

std::string headText(const CentralRig& rig)
{
    return cv::format("central camera(s) nearest to '%s' for z = %g ... %g before each camera: an approximation, only there",
                      rig.source.c_str(), rig.range[0], rig.range[1]);
}

} // namespace tools
