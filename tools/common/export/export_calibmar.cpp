// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/colmap_port.hpp"
#include "export/export_files.hpp"

/* Calibmar knows windows: what it can be told is exact. Its lenses and ports are COLMAP's, whose pixel (0, 0) is a corner. */

namespace tools {

namespace {

std::string listOf(const std::vector<double>& numbers)
{
    std::string text;
    for (double number : numbers)
        text += cv::format("%s%.17g", text.empty() ? "" : ", ", number);
    return "[" + text + "]";
}

} // namespace

std::vector<ExportFile> calibmarFiles(const Calibration& calibration, const std::string& source)
{
    std::vector<ExportFile> files;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        const cv::refract::RefractiveCamera& camera = *calibration.cameras[c].camera;
        const std::string name = cv::format("camera%zu", c + 1);
        const ColmapCamera lens = exactColmapCamera(camera, 1, name, "Calibmar");
        const ColmapPort port = colmapPortOf(camera.window(), name, "Calibmar");
        files.push_back({name + ".yaml", "# of " + source + (calibration.unit.empty() ? "" : ", lengths in " + calibration.unit) + "\n"
            + "model: " + lens.model + "\nparameters: " + listOf(lens.parameters) + "\n"
            + "non_svp_model: " + (port.model.empty() ? "NONE" : port.model) + "\nnon_svp_parameters: " + listOf(port.parameters) + "\n"
            + cv::format("width: %d\nheight: %d\n", camera.imageSize().width, camera.imageSize().height)});
    }
    return files;
}

} // namespace tools
