// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/render_scene.hpp"
#include "simulate/light_source.hpp"

#include <cmath>
#include <functional>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Size;
using cv::Vec3d;
using cv::Vec3f;

namespace {

const Vec3d LAMP = cv::normalize(Vec3d(-0.5, -0.6, -0.8));      // towards it
const double AMBIENT = 0.35;                                    // share of the light that comes from everywhere

using PixelOfSample = std::function<Point2d(int x, int y)>;
using Visit = std::function<void(int x, int y, const SceneRay& ray, const SurfaceHit& hit)>;

//! Row by row, as unprojecting wants many pixels at a time.
void traceRays(const TexturedScene& scene, const Viewpoint& view, Size samples, const PixelOfSample& pixelOf, const Visit& visit)
{
    cv::parallel_for_(cv::Range(0, samples.height), [&](const cv::Range& range) {
        std::vector<Point2d> pixels(samples.width);
        for (int y = range.start; y < range.end; y++)
        {
            for (int x = 0; x < samples.width; x++)
                pixels[x] = pixelOf(x, y);
            const std::vector<SceneRay> rays = raysOf(pixels, view);
            for (int x = 0; x < samples.width; x++)
                visit(x, y, rays[x], firstSurface(scene, rays[x]));
        }
    });
}

//! Share of the light that a surface sends back, whichever of its sides is seen.
double lambert(const Intersection& hit, const Vec3d& direction)
{
    const double towards = hit.normal.dot(LAMP)*(hit.normal.dot(direction) > 0 ? -1 : 1);
    return AMBIENT + (1 - AMBIENT)*std::max(0., towards);
}

} // namespace

SurfaceHit firstSurface(const TexturedScene& scene, const SceneRay& ray)
{
    SurfaceHit hit;
    if (!std::isnan(ray.direction[0]))
        for (const auto& surface : scene.surfaces)
            if (surface->intersect(ray, hit.intersection))
                hit.surface = surface.get();
    return hit;
}

Mat depthOfScene(const TexturedScene& scene, const Viewpoint& view)
{
    Mat depth(view.camera->imageSize(), CV_32F);
    traceRays(scene, view, depth.size(), [](int x, int y) { return Point2d(x, y); },
              [&](int x, int y, const SceneRay& ray, const SurfaceHit& hit) {
        depth.at<float>(y, x) = hit.surface ? (float)view.depthOf(ray.at(hit.intersection.s)) : NAN;
    });
    return depth;
}

//! The light on the fine grid, blue, green, red.
static Mat lightOf(const TexturedScene& scene, const Viewpoint& view, const Exposure& exposure, const Illumination* light)
{
    const SolidTexture texture(scene.texture, scene.seed);
    const double spacing = pixelAngle(view)/FINE;       // of samples, at range 1
    Mat levels(paddedSize(view.camera->imageSize())*FINE, CV_32FC3), points, reflectance;
    if (light && !light->sources.empty())
    {
        points = Mat(levels.size(), CV_64FC3, cv::Scalar::all(NAN));
        reflectance = Mat::zeros(levels.size(), CV_32FC3);
    }
    traceRays(scene, view, levels.size(), pixelOfSample,
              [&](int x, int y, const SceneRay& ray, const SurfaceHit& hit) {
        Vec3f& level = levels.at<Vec3f>(y, x);
        level = Vec3f::all((float)exposure.background);
        if (!hit.surface)
            return;
        const double s = hit.intersection.s;
        const double grain = texture.at(ray.at(s), s*spacing), lamp = lambert(hit.intersection, ray.direction);
        const Vec3d& color = hit.surface->color();
        for (int channel = 0; channel < 3; channel++)
            level[channel] = (float)(exposure.dark + (exposure.light - exposure.dark)*grain*lamp*color[2 - channel]);
        if (points.empty())
            return;
        points.at<Vec3d>(y, x) = ray.at(s);
        for (int channel = 0; channel < 3; channel++)
            reflectance.at<Vec3f>(y, x)[channel] = (float)(grain*color[2 - channel]);
    });
    if (!points.empty())
        addLight(*light, points, reflectance, &scene, levels);
    return levels;
}

Mat renderScene(const TexturedScene& scene, const Viewpoint& view, const Exposure& exposure, uint64_t seed, const Illumination* light)
{
    Mat levels = lightOf(scene, {view.colours.empty() ? view.camera : view.colours[0], view.R, view.T}, exposure, light);
    for (int channel = 1; channel < (int)view.colours.size(); channel++)
    {
        const int one[] = {channel, channel};
        cv::mixChannels(lightOf(scene, {view.colours[channel], view.R, view.T}, exposure, light), levels, one, 1);
    }
    return expose(levels, exposure, seed);
}

} // namespace tools
