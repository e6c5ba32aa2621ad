// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/surface.hpp"
#include "calibrate/window_face.hpp"
#include "math/rotation.hpp"
#include <algorithm>
#include <cmath>

namespace tools {

using cv::Point2d;
using cv::Vec3d;

namespace {

/* With w the weight along one axis and g a gradient whose components are uniform in -1 ... 1, the noise has the variance
8/3 3 (integral w^2)^2 (integral w^2 t^2) = 0.03646. */
const double GRAIN_STD = 0.190944;
const double GAIN = 0.65;       // at 1 the tanh that keeps the sum in bounds would flatten the lightest and darkest places
const double FAR = 1e12;        // grains: beyond, a double does not tell points of one grain apart

uint64_t mixed(uint64_t bits)
{
    for (int round = 0; round < 2; round++)
    {
        bits ^= bits >> 32;
        bits *= 0x9E3779B97F4A7C15ull;
    }
    return bits ^ (bits >> 29);
}

//! 21 bits of a hash -> -1 ... 1.
double component(uint64_t bits)
{
    return (double)(bits & 0x1FFFFF)/0x100000 - 1;
}

//! 1 at 0, 0 at 1; slope and curvature 0 at both.
double fade(double t)
{
    return 1 - t*t*t*(10 + t*(6*t - 15));
}

//! Gradient noise of lattice spacing 1: 0 at the lattice's points, mean 0, standard deviation GRAIN_STD.
double grain(uint64_t seed, const Vec3d& p)
{
    const double x = std::floor(p[0]), y = std::floor(p[1]), z = std::floor(p[2]);
    const double u = p[0] - x, v = p[1] - y, w = p[2] - z;
    const double weightX[] = {fade(u), fade(1 - u)}, weightY[] = {fade(v), fade(1 - v)}, weightZ[] = {fade(w), fade(1 - w)};
    double sum = 0;
    for (int k = 0; k < 2; k++)
        for (int j = 0; j < 2; j++)
            for (int i = 0; i < 2; i++)
            {
                // Odd factors, far from each other's small multiples: near points get different sums.
                const uint64_t point = (uint64_t)((int64_t)x + i)*0x8DA6B343CB1AB531ull
                                       + (uint64_t)((int64_t)y + j)*0xD8163841FE5C47A9ull
                                       + (uint64_t)((int64_t)z + k)*0x2F4A1B97D6E8A4C5ull;
                const uint64_t hash = mixed(seed ^ point);
                sum += weightX[i]*weightY[j]*weightZ[k]
                       *(component(hash)*(u - i) + component(hash >> 21)*(v - j) + component(hash >> 42)*(w - k));
            }
    return sum;
}

//! Share of an octave that samples so far apart can show without showing something else: all of two samples a grain, none of one.
double shown(double spacing, double size)
{
    return std::clamp(size/spacing - 1, 0., 1.);
}

} // namespace

SolidTexture::SolidTexture(const TextureOptions& options, uint64_t seed)
    : contrast_(options.contrast), scale_(GAIN/(GRAIN_STD*std::sqrt((double)options.octaves)))
{
    turn_ = cv::refract::rotationMatrix(Vec3d(0.5, 0.7, 0.3));
    double size = options.size;
    for (int i = 0; i < options.octaves; i++, size /= 2)
        octaves_.push_back({size, mixed(seed*64 + i + 1)});
}

double SolidTexture::at(const Vec3d& point, double spacing) const
{
    const Vec3d turned = turn_*point;
    double sum = 0;
    for (const Octave& octave : octaves_)
    {
        const double share = shown(spacing, octave.size);
        const Vec3d inGrains = turned*(1/octave.size);
        if (!(share > 0) || !(cv::norm(inGrains, cv::NORM_INF) < FAR))      // the finer ones neither
            break;
        sum += share*grain(octave.seed, inGrains);
    }
    return 1 - contrast_*(0.5 - 0.5*std::tanh(scale_*sum));
}

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
