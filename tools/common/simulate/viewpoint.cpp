// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/viewpoint.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tools {

using cv::Point2d;
using cv::Vec3d;
using cv::refract::GlassWindow;

namespace {

//! From the centre of projection to the last surface, along the normal; no window has none.
double lastSurface(const GlassWindow& w)
{
    if (w.thickness.empty() && w.innerIndex == w.outerIndex)
        return -std::numeric_limits<double>::infinity();
    return std::accumulate(w.thickness.begin(), w.thickness.end(), w.distance);
}

} // namespace

std::vector<SceneRay> raysOf(const std::vector<Point2d>& pixels, const Viewpoint& view)
{
    std::vector<cv::Point3d> origins, directions;
    cv::refract::refractiveUnprojectPoints(pixels, origins, directions, view.camera);
    const GlassWindow window = view.camera->window();
    const double last = lastSurface(window);
    const cv::Matx33d back = view.R.t();
    std::vector<SceneRay> rays;
    rays.reserve(pixels.size());
    for (size_t i = 0; i < pixels.size(); i++)
    {
        // The origin is not where light is, but where the line of the ray meets the window's axis.
        const Vec3d origin(origins[i]), direction(directions[i]);
        const double leaving = (last - window.normal.dot(origin))/window.normal.dot(direction);
        rays.push_back({back*(origin - view.T), back*direction, std::max(leaving, 0.)});
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
