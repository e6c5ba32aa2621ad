// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/surface.hpp"
#include "calibrate/window_face.hpp"
#include <algorithm>
#include <cmath>

namespace tools {

using cv::Vec3d;
using cv::Point2d;

namespace {

const double INF = std::numeric_limits<double>::infinity();

} // namespace

bool Sphere::intersect(const SceneRay& ray, Intersection& first) const
{
    // Both distances from the point of the ray nearest to the centre: without the cancellation of the textbook's formula.
    const double middle = ray.direction.dot(center_ - ray.origin);
    const double beside = cv::norm(ray.at(middle) - center_);
    const double half = std::sqrt((radius_ - beside)*(radius_ + beside));       // NaN: past the sphere
    const double s = middle - half > ray.least ? middle - half : middle + half;
    if (!(s > ray.least && s < first.s))
        return false;
    first = {s, (ray.at(s) - center_)*(1/radius_)};
    return true;
}

Plane::Plane(const Vec3d& point, const Vec3d& normal, const Vec3d& color)
    : Surface(color), point_(point), normal_(cv::normalize(normal)), half_(INF, INF)
{
}

Plane::Plane(const Vec3d& point, const Vec3d& normal, const Vec3d& right, const cv::Size2d& half, const Vec3d& color)
    : Surface(color), point_(point), normal_(cv::normalize(normal)),
      right_(cv::normalize(right - right.dot(normal_)*normal_)), down_(normal_.cross(right_)), half_(half)
{
}

bool Plane::intersect(const SceneRay& ray, Intersection& first) const
{
    const double s = normal_.dot(point_ - ray.origin)/normal_.dot(ray.direction);
    if (!(s > ray.least && s < first.s))
        return false;
    const Vec3d offset = ray.at(s) - point_;
    if (!(std::abs(offset.dot(right_)) <= half_.width && std::abs(offset.dot(down_)) <= half_.height))
        return false;
    first = {s, normal_};
    return true;
}

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
