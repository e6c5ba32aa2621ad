// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/true_line.hpp"

#include <cmath>

namespace tools {

using cv::Point2d;
using cv::Vec3d;

namespace {

const double SAME_SURFACE = 1e-5;       // of the distance

std::vector<SceneRay> sheetOf(const LightSource& source, bool window)
{
    std::vector<Point2d> pixels;
    for (int v = 0; v < source.emitter.camera->imageSize().height; v++)
        pixels.emplace_back(source.emitter.line, v);
    return raysOf(pixels, source.view(window));
}

//! What of the points is in the image, and no surface is before it.
TrueLine seenOf(const std::vector<Vec3d>& points, const TexturedScene* scene, const Viewpoint& camera)
{
    TrueLine line;
    if (points.empty())
        return line;
    std::vector<Point2d> pixels;
    cv::refract::refractiveProjectPoints(std::vector<cv::Point3d>(points.begin(), points.end()), camera.R, camera.T, camera.camera, pixels);
    const std::vector<SceneRay> rays = raysOf(pixels, camera);
    const cv::Size size = camera.camera->imageSize();
    for (size_t i = 0; i < points.size(); i++)
    {
        const double distance = rays[i].direction.dot(points[i] - rays[i].origin);
        const bool hidden = scene && !(firstSurface(*scene, rays[i]).intersection.s > distance*(1 - SAME_SURFACE));
        const bool inside = pixels[i].x >= -0.5 && pixels[i].y >= -0.5 && pixels[i].x < size.width - 0.5 && pixels[i].y < size.height - 0.5;
        if (!inside || hidden)
            continue;
        line.pixels.push_back(pixels[i]);
        line.points.push_back(points[i]);
    }
    return line;
}

} // namespace

TrueLine trueLine(const LightSource& source, bool window, const TexturedScene& scene, const Viewpoint& camera)
{
    std::vector<Vec3d> points;
    for (const SceneRay& ray : sheetOf(source, window))
    {
        const SurfaceHit hit = firstSurface(scene, ray);
        if (hit.surface)
            points.push_back(ray.at(hit.intersection.s));
    }
    return seenOf(points, &scene, camera);
}

TrueLine trueLine(const LightSource& source, bool window, const Target& target, const BoardPose& pose, const Viewpoint& camera)
{
    const cv::Matx33d R = rotationMatrix(pose.rvec);
    const Plane plane(pose.tvec, Vec3d(R(0, 2), R(1, 2), R(2, 2)), Vec3d(1, 1, 1));
    std::vector<Vec3d> points;
    for (const SceneRay& ray : sheetOf(source, window))
    {
        Intersection hit;
        if (!plane.intersect(ray, hit))
            continue;
        const Vec3d onTarget = R.t()*(ray.at(hit.s) - pose.tvec)*(1/target.square());
        if (isOnBoard(target, onTarget[0], onTarget[1]))
            points.push_back(ray.at(hit.s));
    }
    return seenOf(points, nullptr, camera);
}

} // namespace tools
