// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/light_source.hpp"
#include "calibrate/rig_model.hpp"
#include "console/failure.hpp"
#include "console/keys.hpp"
#include "console/progress.hpp"
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Size;
using cv::Vec3d;
using cv::Vec3f;
using cv::refract::GlassWindow;

namespace {

const double DARK = 1e-4;               // what is darker needs no shadow
const double SAME_SURFACE = 1e-5;       // of the distance: closer hits are the lit surface itself

//! Grains of a mean of 1, lognormal.
Mat speckleOf(const LightSource& source, cv::Size samples, uint64_t seed)
{
    Mat grains(samples, CV_32F);
    cv::RNG rng(seed);
    rng.fill(grains, cv::RNG::NORMAL, 0., 1.);
    cv::GaussianBlur(grains, grains, cv::Size(), source.speckleSize*FINE);
    cv::Scalar mean, deviation;
    cv::meanStdDev(grains, mean, deviation);
    const double sigma = std::sqrt(std::log(1 + source.speckle*source.speckle));
    grains = (grains - mean[0])*(sigma/deviation[0]) - 0.5*sigma*sigma;
    cv::exp(grains, grains);
    return grains;
}

//! Whether the emitter's light arrives at a point, which is lit by its pixel.
std::vector<bool> areLit(const TexturedScene& scene, const Viewpoint& emitter, const std::vector<Point2d>& pixels,
                         const std::vector<Vec3d>& points)
{
    const std::vector<SceneRay> rays = raysOf(pixels, emitter);
    std::vector<bool> lit;
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const double distance = rays[i].direction.dot(points[i] - rays[i].origin);
        lit.push_back(firstSurface(scene, rays[i]).intersection.s > distance*(1 - SAME_SURFACE));
    }
    return lit;
}

//! What a source sends to a row of points, 0 ... 1.
void lightRow(const LightSource& source, int picture, const Viewpoint& view, const Vec3d* points, int count, const TexturedScene* scene,
              float* light)
{
    std::vector<Point2d> pixels;
    std::vector<cv::Point3d> X(points, points + count);
    cv::refract::refractiveProjectPoints(X, view.R, view.T, view.camera, pixels);
    std::vector<int> bright;
    for (int x = 0; x < count; x++)
    {
        const bool inside = pixels[x].y >= -0.5 && pixels[x].y <= view.camera->imageSize().height - 0.5;
        light[x] = inside ? (float)source.at(pixels[x].x, picture) : 0.f;
        if (scene && light[x] > DARK)
            bright.push_back(x);
    }
    if (bright.empty())
        return;
    std::vector<Point2d> sent;
    std::vector<Vec3d> at;
    for (int x : bright)
    {
        sent.push_back(pixels[x]);
        at.push_back(points[x]);
    }
    const std::vector<bool> lit = areLit(*scene, view, sent, at);
    for (size_t i = 0; i < bright.size(); i++)
        if (!lit[i])
            light[bright[i]] = 0.f;
}

void readFringes(const cv::FileNode& node, const std::string& name, LightSource& source)
{
    const Keys keys(node, name + ", fringes");
    keys.allowOnly({"periods", "steps", "phase"});
    node["periods"] >> source.periods;
    if (source.periods.empty() || !(*std::min_element(source.periods.begin(), source.periods.end()) > 0) || !cv::checkRange(source.periods))
        throw Failure(keys.name() + ": 'periods' must be a list of pixels of the emitter, each more than 0");
    source.steps = (int)keys.number("steps", 3, 100, 4);
    source.phase = keys.number("phase", -1e3, 1e3, 0);
}

LightSource readSource(const cv::FileNode& node, const std::string& filename)
{
    LightSource source;
    source.name = node.name();
    const Keys keys(node, "'" + filename + "': emitters, " + source.name);
    std::vector<std::string> known = emitterKeys();
    known.insert(known.end(), {"width", "brightness", "color", "speckle", "speckle_size", "fringes"});
    keys.allowOnly(known);
    if (keys.has("line") == keys.has("fringes"))
        throw Failure(keys.name() + ": give either 'line', the u of a sheet of light, or 'fringes'");
    source.emitter = readEmitter(node, keys.name(), keys.has("line"));
    if (source.emitter.camera->imageSize().empty())
        throw Failure(keys.name() + ": image_width and image_height are needed: it sends no light outside of them");
    source.brightness = keys.number("brightness", 0, 1e4);
    source.speckle = keys.number("speckle", 0, 2, 0);
    source.speckleSize = keys.number("speckle_size", 0.1, 20, source.speckleSize);
    source.color = keys.vector("color", Vec3d(1, 1, 1));
    for (int i = 0; i < 3; i++)
        if (!(source.color[i] >= 0 && source.color[i] <= 1))
            throw Failure(keys.name() + ": 'color' must be red, green and blue from 0 to 1");
    if (keys.has("fringes"))
        readFringes(node["fringes"], keys.name(), source);
    else
        source.width = keys.number("width", 1e-3, 1e3);
    return source;
}

} // namespace

double LightSource::at(double u, int picture) const
{
    if (!(u >= -0.5 && u <= emitter.camera->imageSize().width - 0.5))
        return 0.;
    if (isLine())
    {
        const double t = (u - emitter.line)/width;
        return std::exp(-4*std::log(2.)*t*t);
    }
    return 0.5 + 0.5*std::cos(2*CV_PI*(u/periods[picture/steps] - double(picture % steps)/steps) + phase);
}

Viewpoint LightSource::view(bool window) const
{
    const auto camera = copyWithWindow(emitter.camera, window ? emitter.camera->window() : GlassWindow());
    camera->setImageSize(emitter.camera->imageSize());
    return {camera, emitter.R, emitter.translation()};
}

std::vector<LightSource> readLightSources(const cv::FileNode& emitters, const std::string& filename)
{
    std::vector<LightSource> sources;
    if (!emitters.empty() && !emitters.isMap())
        throw Failure("'" + filename + "': 'emitters' must be emitters by name, as in laser: { ... }");
    for (const cv::FileNode& node : emitters)
        sources.push_back(readSource(node, filename));
    return sources;
}

void addLight(const Illumination& light, const Mat& points, const Mat& reflectance, const TexturedScene* scene, Mat& levels)
{
    for (size_t i = 0; i < light.sources.size(); i++)
    {
        const LightSource& source = light.sources[i];
        const Viewpoint view = source.view(light.window);
        Mat sent(points.size(), CV_32F);
        inParallel(points.rows, [&](int y) {
            lightRow(source, light.picture, view, points.ptr<Vec3d>(y), points.cols, scene, sent.ptr<float>(y)); });
        if (source.speckle > 0)
            sent = sent.mul(speckleOf(source, points.size(), light.seed + i));
        const Vec3d bgr(source.color[2], source.color[1], source.color[0]);
        for (int y = 0; y < levels.rows; y++)
            for (int x = 0; x < levels.cols; x++)
                for (int c = 0; c < 3; c++)
                    levels.at<Vec3f>(y, x)[c] += (float)(source.brightness*bgr[c])*sent.at<float>(y, x)*reflectance.at<Vec3f>(y, x)[c];
    }
}

namespace {

void vignette(Mat& levels, double loss)
{
    const Point2d centre(0.5*(levels.cols - 1), 0.5*(levels.rows - 1));
    const int channels = levels.channels();
    for (int y = 0; y < levels.rows; y++)
        for (int x = 0; x < levels.cols; x++)
        {
            const Point2d offset = Point2d(x, y) - centre;
            const float share = (float)(1 - loss*offset.dot(offset)/centre.dot(centre));
            for (int channel = 0; channel < channels; channel++)
                levels.ptr<float>(y, x)[channel] *= share;
        }
}

} // namespace

Mat expose(Mat& levels, const Exposure& exposure, uint64_t seed)
{
    if (exposure.blur > 0)
        cv::GaussianBlur(levels, levels, Size(), exposure.blur*FINE);
    cv::resize(levels, levels, levels.size()/FINE, 0, 0, cv::INTER_AREA);
    levels = levels(cv::Rect(cv::Point(PAD, PAD), levels.size() - Size(2*PAD, 2*PAD))).clone();
    vignette(levels, exposure.vignetting);
    Mat noise(levels.rows, levels.cols*levels.channels(), CV_32F);      // of each channel its own
    cv::RNG rng(seed);
    rng.fill(noise, cv::RNG::NORMAL, 0., exposure.noise);
    levels += noise.reshape(levels.channels());
    Mat image;
    levels.convertTo(image, CV_8U);
    return image;
}

} // namespace tools
