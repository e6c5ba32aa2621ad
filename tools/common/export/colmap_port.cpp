// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/colmap_port.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"

namespace tools {

using cv::refract::GlassWindow;
using cv::refract::RefractiveCamera;

ColmapPort colmapPortOf(const GlassWindow& window, const std::string& name, const std::string& program)
{
    if (!refracts(window))
        return {};
    const bool isDome = window.shape == cv::refract::WINDOW_DOME, isFlat = window.shape == cv::refract::WINDOW_FLAT;
    if ((!isDome && !isFlat) || window.thickness.size() > 1)
        throw Failure(name + " looks through a window that " + program + " has none like: it has flat ones and domes, of one layer");
    for (const cv::Vec2d& wedge : window.wedge)
        if (wedge != cv::Vec2d())
            throw Failure(name + " looks through a window with a wedge, and " + program + " has none: calibrate with --wedge-std=0");
    const bool isBare = window.thickness.empty();       // a surface is a port of no thickness, whose index does not matter
    const cv::Vec3d where = isDome ? window.center : window.normal;
    return {isDome ? "DOMEPORT" : "FLATPORT",
            {where[0], where[1], where[2], isDome ? window.radius : window.distance, isBare ? 0. : window.thickness[0],
             window.innerIndex, isBare ? window.outerIndex : window.index[0], window.outerIndex}};
}

ColmapCamera exactColmapCamera(const RefractiveCamera& camera, uint32_t id, const std::string& name, const std::string& program)
{
    const size_t MOST = 4 + 8;          // focal lengths, centre, coefficients
    const bool isFisheye = camera.lensModel() == "fisheye";
    if ((!isFisheye && (camera.lensModel() != "opencv" || camera.lensParameters().total() > MOST))
        || camera.cameraMatrix().at<double>(0, 1) != 0.)
        throw Failure(name + " has a lens that " + program + " has none like: it has OpenCV's with up to eight coefficients, and "
                      "cv::fisheye's without skew");
    return colmapCameraOf(camera, id);
}

} // namespace tools
