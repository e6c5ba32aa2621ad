// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/surface.hpp"

#include <cmath>

namespace tools {

using cv::Vec3d;

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

} // namespace tools
