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

//! The last surface of a window, as normal.X = distance; no window has none.
struct LastSurface
{
    explicit LastSurface(const GlassWindow& w)
        : normal(w.normal), distance(std::accumulate(w.thickness.begin(), w.thickness.end(), w.distance))
    {
        if (w.thickness.empty() && w.innerIndex == w.outerIndex)
            distance = -std::numeric_limits<double>::infinity();
        const cv::Vec2d lean = std::accumulate(w.wedge.begin(), w.wedge.end(), cv::Vec2d());
        const double angle = cv::norm(lean);
        if (angle == 0)
            return;
        const Vec3d n = w.normal, e1 = cv::normalize(Vec3d(1, 0, 0) - n[0]*n), e2 = n.cross(e1);
        normal = std::cos(angle)*n + std::sin(angle)/angle*(lean[0]*e1 + lean[1]*e2);
        distance *= std::cos(angle);
    }
    Vec3d normal;
    double distance;
};

} // namespace

std::vector<SceneRay> raysOf(const std::vector<Point2d>& pixels, const Viewpoint& view)
{
    std::vector<cv::Point3d> origins, directions;
    cv::refract::refractiveUnprojectPoints(pixels, origins, directions, view.camera);
    const LastSurface last(view.camera->window());
    const cv::Matx33d back = view.R.t();
    std::vector<SceneRay> rays;
    rays.reserve(pixels.size());
    for (size_t i = 0; i < pixels.size(); i++)
    {
        // The origin is not where light is, but where the line of the ray meets the window's axis, or nearly does.
        const Vec3d origin(origins[i]), direction(directions[i]);
        const double leaving = (last.distance - last.normal.dot(origin))/last.normal.dot(direction);
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
