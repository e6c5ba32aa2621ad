// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/render.hpp"
#include "console/progress.hpp"
#include "simulate/light_source.hpp"
#include <opencv2/imgproc.hpp>
#include <cmath>
#include <functional>

namespace tools {

using cv::Mat;
using cv::Matx33d;
using cv::Point2d;
using cv::Size;
using cv::Vec2d;
using cv::Vec3d;
using cv::Vec3f;

namespace {

const int PARTS = 8;        // points per sample at an edge, each way
const int DRAWING = 240;    // pixels per square of a ChArUco board's drawing

//! From the first point to the last and a square more.
cv::Size2d squaresOf(const Target& target)
{
    cv::Size2d last;
    for (const cv::Point3d& p : target.objectPoints())
        last = cv::Size2d(std::max(last.width, p.x), std::max(last.height, p.y));
    return cv::Size2d(last.width/target.square() + 1, last.height/target.square() + 1);
}

bool isInside(double s, double t, double columns, double rows) { return s > -1.5 && t > -1.5 && s < columns + 0.5 && t < rows + 0.5; }

//! Grey level of the target's plane at (s, t) in units of --square, (0, 0) the first point.
class Paint
{
public:
    Paint(const Target& target, const Exposure& exposure) : pattern_(target.pattern()), exposure_(exposure)
    {
        drawing_ = target.drawing(DRAWING);
        border_ = target.border();
        radius_ = target.dotRadius()/target.square();
        columns_ = squaresOf(target).width;
        rows_ = squaresOf(target).height;
    }

    double operator()(double s, double t) const
    {
        if (!isInside(s, t, columns_, rows_))
            return exposure_.background;
        return isDark(s, t) ? exposure_.dark : exposure_.light;
    }

private:
    bool isDark(double s, double t) const
    {
        const bool inside = s >= -border_ && t >= -border_ && s < columns_ - 1 + border_ && t < rows_ - 1 + border_;
        switch (pattern_)
        {
        case Target::CHESSBOARD:
            return inside && ((int)std::floor(s) + (int)std::floor(t)) % 2 == 0;
        case Target::CHARUCO:           // drawn
        case Target::APRILGRID:
        case Target::CIRCLES:           // dots
        case Target::ACIRCLES:
            break;
        case Target::DOTS:              // not on a board
            return false;
        }
        if (!drawing_.empty())
            return inside && drawing_.at<uchar>(std::min((int)((t + border_)*DRAWING), drawing_.rows - 1),
                                                std::min((int)((s + border_)*DRAWING), drawing_.cols - 1)) < 128;
        for (int row = cvFloor(t); row <= cvFloor(t) + 1; row++)
        {
            if (row < 0 || row >= rows_)
                continue;
            const int step = pattern_ == Target::ACIRCLES ? 2 : 1, shift = pattern_ == Target::ACIRCLES ? row % 2 : 0;
            const int column = cvRound((s - shift)/step)*step + shift;
            if (column >= 0 && column < columns_ && std::hypot(s - column, t - row) < radius_)
                return true;
        }
        return false;
    }

    Target::Pattern pattern_;
    Exposure exposure_;
    double border_, radius_, columns_, rows_;
    Mat drawing_;           // of a board with markers
};

//! Target coordinates, in squares, that every pixel of the padded image sees; NaN where it sees nothing.
Mat traceTarget(const Target& target, const BoardPose& pose, const cv::Ptr<cv::refract::RefractiveCamera>& camera)
{
    const Size size = paddedSize(camera->imageSize());
    Mat pixels(size, CV_64FC2);
    for (int y = 0; y < size.height; y++)
        for (int x = 0; x < size.width; x++)
            pixels.at<Vec2d>(y, x) = Vec2d(x - PAD, y - PAD);
    const Matx33d R = rotationMatrix(pose.rvec);
    const Vec3d normal(R(0, 2), R(1, 2), R(2, 2));
    Mat points;
    cv::refract::refractivePointsOnPlane(pixels.reshape(2, (int)pixels.total()), points, camera,
                                         cv::Vec4d(normal[0], normal[1], normal[2], normal.dot(pose.tvec)));
    Mat coordinates(size, CV_64FC2);
    const Vec3d* point = points.ptr<Vec3d>();
    for (int y = 0; y < size.height; y++)
        for (int x = 0; x < size.width; x++)
        {
            const Vec3d onTarget = R.t()*(*point++ - pose.tvec)*(1./target.square());
            coordinates.at<Vec2d>(y, x) = Vec2d(onTarget[0], onTarget[1]);
        }
    return coordinates;
}

//! Mean grey level of the parallelogram with the sides du, dv round the centre.
double meanLevel(const Paint& paint, const Vec2d& centre, const Vec2d& du, const Vec2d& dv)
{
    const double middle = paint(centre[0], centre[1]);
    bool edge = false;
    for (const double a : {-0.5, 0.5})
        for (const double b : {-0.5, 0.5})
        {
            const Vec2d corner = centre + a*du + b*dv;
            edge = edge || paint(corner[0], corner[1]) != middle;
        }
    if (!edge)
        return middle;
    double sum = 0;
    for (int i = 0; i < PARTS; i++)
        for (int j = 0; j < PARTS; j++)
        {
            const Vec2d part = centre + ((i + 0.5)/PARTS - 0.5)*du + ((j + 0.5)/PARTS - 0.5)*dv;
            sum += paint(part[0], part[1]);
        }
    return sum/(PARTS*PARTS);
}

//! The light that falls on the fine grid, before blur.
Mat paintFine(const Paint& paint, const Mat& coordinates)
{
    Mat fine, levels(coordinates.size()*FINE, CV_32F);
    cv::resize(coordinates, fine, levels.size(), 0, 0, cv::INTER_LINEAR);    // aligned by pixel areas, as needed here
    inParallel(fine.rows, [&](int y) {
        for (int x = 0; x < fine.cols; x++)
        {
            const int x0 = std::min(x, fine.cols - 2), y0 = std::min(y, fine.rows - 2);
            const Vec2d du = fine.at<Vec2d>(y0, x0 + 1) - fine.at<Vec2d>(y0, x0);
            const Vec2d dv = fine.at<Vec2d>(y0 + 1, x0) - fine.at<Vec2d>(y0, x0);
            levels.at<float>(y, x) = (float)meanLevel(paint, fine.at<Vec2d>(y, x), du, dv);
        }
    });
    return levels;
}

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

//! On the board, and not on what is behind it. @param s, t in units of --square, (0, 0) the first point
bool isOnBoard(const Target& target, double s, double t) { return isInside(s, t, squaresOf(target).width, squaresOf(target).height); }

//! What emitters add, on the fine grid. @param pose in camera 1
static void lightBoard(const Target& target, const BoardPose& pose, const Mat& coordinates, const Illumination& light,
                       const Exposure& exposure, Mat& levels)
{
    Mat fine, points(levels.size(), CV_64FC3), reflectance(levels.size(), CV_32FC3);
    cv::resize(coordinates, fine, levels.size(), 0, 0, cv::INTER_LINEAR);
    const Matx33d R = rotationMatrix(pose.rvec);
    for (int y = 0; y < fine.rows; y++)
        for (int x = 0; x < fine.cols; x++)
        {
            const Vec2d p = fine.at<Vec2d>(y, x);
            points.at<Vec3d>(y, x) = R*Vec3d(p[0]*target.square(), p[1]*target.square(), 0) + pose.tvec;
            reflectance.at<cv::Vec3f>(y, x) = isOnBoard(target, p[0], p[1]) ? levels.at<cv::Vec3f>(y, x)*(1/exposure.light) : cv::Vec3f();
        }
    addLight(light, points, reflectance, nullptr, levels);
}

Mat render(const Target& target, const BoardPose& pose, const Viewpoint& view, const Exposure& exposure, uint64_t seed,
           const Illumination* light)
{
    const BoardPose inView = inOtherCamera(pose, {view.R, view.T});
    const bool lit = light && !light->sources.empty();
    std::vector<Mat> channels;
    for (size_t c = 0; c < std::max<size_t>(view.colours.size(), 1); c++)
    {
        const Mat coordinates = traceTarget(target, inView, view.colours.empty() ? view.camera : view.colours[c]);
        Mat channel = paintFine(Paint(target, exposure), coordinates);
        if (lit)
        {
            Mat levels;
            cv::merge(std::vector<Mat>(3, channel), levels);
            lightBoard(target, pose, coordinates, *light, exposure, levels);
            if (view.colours.empty())
                cv::split(levels, channels);
            else
                cv::extractChannel(levels, channel, (int)c);
        }
        if (!lit || !view.colours.empty())
            channels.push_back(channel);
    }
    Mat levels;
    cv::merge(channels, levels);
    return expose(levels, exposure, seed);
}

BoardPose inOtherCamera(const BoardPose& pose, const RigidTransform& cam2_from_cam1)
{
    const RigidTransform board = cam2_from_cam1*transformOf(pose.rvec, pose.tvec);
    return {rotationVector(board.R), board.t};
}

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
