// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/viewpoint.hpp"
#include "calibrate/window_face.hpp"

#include <algorithm>
#include <cmath>

namespace tools {

using cv::Point2d;
using cv::Vec3d;

std::vector<SceneRay> raysOf(const std::vector<Point2d>& pixels, const Viewpoint& view)
{
    std::vector<cv::Point3d> origins, directions;
    cv::refract::refractiveUnprojectPoints(pixels, origins, directions, view.camera);
    const WindowFace last = WindowFace::last(view.camera->window());
    const cv::Matx33d back = view.R.t();
    std::vector<SceneRay> rays;
    rays.reserve(pixels.size());
    for (size_t i = 0; i < pixels.size(); i++)
    {
        // The origin is not where light is, but where the line of the ray meets the window's axis, or nearly does.
        const Vec3d origin(origins[i]), direction(directions[i]);
        rays.push_back({back*(origin - view.T), back*direction, std::max(last.along(origin, direction), 0.)});
    }
    return rays;
}

double pixelAngle(const Viewpoint& view)
{
    const Point2d centre = 0.5*Point2d(cv::Size2d(view.camera->imageSize()));
    const std::vector<SceneRay> rays = raysOf({centre, centre + Point2d(1, 0)}, view);
    const double angle = cv::norm(rays[1].direction - rays[0].direction);
    return std::isnan(angle) ? 0 : angle;
}

} // namespace tools
