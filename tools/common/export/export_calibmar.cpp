// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/export_files.hpp"
#include "console/failure.hpp"

/* Calibmar knows windows: what it can be told is exact. Its lenses and ports are COLMAP's, whose pixel (0, 0) is a corner. */

namespace tools {

namespace {

using cv::refract::GlassWindow;
using cv::refract::RefractiveCamera;

const double CORNER = 0.5;

std::string listOf(const std::vector<double>& numbers)
{
    std::string text;
    for (double number : numbers)
        text += cv::format("%s%.17g", text.empty() ? "" : ", ", number);
    return "[" + text + "]";
}

//! Its name, and the parameters as many as it has.
std::string lensOf(const RefractiveCamera& camera, const std::string& name)
{
    const bool isFisheye = camera.lensModel() == "fisheye";
    std::vector<double> p = camera.lensParameters();
    const size_t focalAndCentre = 4, coefficients = p.size() - focalAndCentre;
    const cv::Mat K = camera.cameraMatrix();
    if ((!isFisheye && (camera.lensModel() != "opencv" || coefficients > 8)) || K.at<double>(0, 1) != 0.)
        throw Failure(name + " has a lens that Calibmar has none like: it has OpenCV's with up to eight coefficients, and cv::fisheye's "
                      "without skew");
    p[2] += CORNER;
    p[3] += CORNER;
    const bool isFull = !isFisheye && coefficients > 4;
    p.resize(focalAndCentre + (isFull ? 8 : 4), 0.);
    return std::string("model: ") + (isFisheye ? "OPENCV_FISHEYE" : isFull ? "FULL_OPENCV" : "OPENCV")
         + "\nparameters: " + listOf(p) + "\n";
}

std::string portOf(const GlassWindow& window, const std::string& name)
{
    if (window.thickness.empty() && window.innerIndex == window.outerIndex)
        return "non_svp_model: NONE\nnon_svp_parameters: []\n";
    const bool isDome = window.shape == cv::refract::WINDOW_DOME, isFlat = window.shape == cv::refract::WINDOW_FLAT;
    if ((!isDome && !isFlat) || window.thickness.size() > 1)
        throw Failure(name + " looks through a window that Calibmar has none like: it has flat ones and domes, of one layer");
    for (const cv::Vec2d& wedge : window.wedge)
        if (wedge != cv::Vec2d())
            throw Failure(name + " looks through a window with a wedge, and Calibmar has none: calibrate with --wedge-std=0");
    const bool isBare = window.thickness.empty();       // a surface is a port of no thickness, whose index does not matter
    const cv::Vec3d where = isDome ? window.center : window.normal;
    return std::string("non_svp_model: ") + (isDome ? "DOMEPORT" : "FLATPORT") + "\nnon_svp_parameters: "
         + listOf({where[0], where[1], where[2], isDome ? window.radius : window.distance, isBare ? 0. : window.thickness[0],
                   window.innerIndex, isBare ? window.outerIndex : window.index[0], window.outerIndex}) + "\n";
}

} // namespace

std::vector<ExportFile> calibmarFiles(const Calibration& calibration, const std::string& source)
{
    std::vector<ExportFile> files;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        const RefractiveCamera& camera = *calibration.cameras[c].camera;
        const std::string name = cv::format("camera%zu", c + 1);
        files.push_back({name + ".yaml", "# of " + source + (calibration.unit.empty() ? "" : ", lengths in " + calibration.unit) + "\n"
            + lensOf(camera, name) + portOf(camera.window(), name)
            + cv::format("width: %d\nheight: %d\n", camera.imageSize().width, camera.imageSize().height)});
    }
    return files;
}

} // namespace tools
