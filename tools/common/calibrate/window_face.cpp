// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/window_face.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

using cv::Vec2d;
using cv::Vec3d;
using cv::refract::GlassWindow;

namespace tools {

double glassOf(const GlassWindow& window) { return std::accumulate(window.thickness.begin(), window.thickness.end(), 0.); }

const char* nameOfShape(const GlassWindow& window)
{
    switch (window.shape)
    {
    case cv::refract::WINDOW_DOME: return "dome";
    case cv::refract::WINDOW_TUBE: return "tube";
    case cv::refract::WINDOW_BENT: return "bent window";
    default: return "window";
    }
}

double tiltDegrees(const GlassWindow& window) { return std::acos(std::min(1., window.normal[2]))*180./CV_PI; }

double offsetOf(const GlassWindow& window)
{
    const bool isTube = window.shape == cv::refract::WINDOW_TUBE;
    return cv::norm(isTube ? window.center - window.axis.dot(window.center)*window.axis : window.center);
}

double placeChange(const GlassWindow& before, const GlassWindow& after)
{
    if (!isRound(before))
        return std::atan2(cv::norm(before.normal.cross(after.normal)), before.normal.dot(after.normal))*180./CV_PI;
    const Vec3d moved = after.center - before.center;
    return cv::norm(before.shape == cv::refract::WINDOW_TUBE ? moved - before.axis.dot(moved)*before.axis : moved);
}

std::string placeUnit(const GlassWindow& window, const std::string& unit) { return isRound(window) ? unit : "deg"; }

const char* placeName(const GlassWindow& window) { return isRound(window) ? "centre" : "normal"; }

WindowFace::WindowFace(const GlassWindow& window, double glass, Vec2d lean)
    : isNone_(!refracts(window))
{
    if (isRound(window))
    {
        point_ = window.center;
        radius_ = window.radius + glass;
        if (window.shape == cv::refract::WINDOW_TUBE)
            axis_ = window.axis;
        return;
    }
    normal_ = window.normal;
    point_ = (window.distance + glass)*window.normal;
    if (window.shape == cv::refract::WINDOW_BENT)
        curvature_ = window.curvature/(1. + glass*window.curvature);
    const double angle = cv::norm(lean);
    if (angle == 0)
        return;
    const Vec3d n = window.normal, e1 = cv::normalize(Vec3d(1, 0, 0) - n[0]*n), e2 = n.cross(e1);
    normal_ = std::cos(angle)*n + std::sin(angle)/angle*(lean[0]*e1 + lean[1]*e2);
}

WindowFace WindowFace::first(const GlassWindow& window) { return WindowFace(window, 0., Vec2d()); }

WindowFace WindowFace::last(const GlassWindow& window)
{
    return WindowFace(window, glassOf(window), std::accumulate(window.wedge.begin(), window.wedge.end(), Vec2d()));
}

double WindowFace::along(const Vec3d& origin, const Vec3d& direction) const
{
    if (isNone_)
        return -std::numeric_limits<double>::infinity();
    if (radius_ > 0.)
    {
        const Vec3d from = origin - point_, p = from - axis_.dot(from)*axis_, d = direction - axis_.dot(direction)*axis_;
        const double a = d.dot(d), b = p.dot(d);
        return (-b + std::sqrt(b*b - a*(p.dot(p) - radius_*radius_)))/a;
    }
    // The smaller root, in the form that a plane has, too.
    const Vec3d p = origin - point_;
    const double a = 0.5*curvature_*direction.dot(direction), b = normal_.dot(direction) + curvature_*p.dot(direction);
    const double c = normal_.dot(p) + 0.5*curvature_*p.dot(p);
    return -2.*c/(b + std::copysign(std::sqrt(b*b - 4.*a*c), b));
}

double WindowFace::beyond(const Vec3d& point) const
{
    if (isNone_)
        return std::numeric_limits<double>::infinity();
    const Vec3d from = point - point_;
    if (radius_ > 0.)
        return cv::norm(from - axis_.dot(from)*axis_) - radius_;
    return normal_.dot(from) + 0.5*curvature_*from.dot(from);
}

} // namespace tools
