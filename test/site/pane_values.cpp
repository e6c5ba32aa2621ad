// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What doc/pane.html should compute: random configurations of it, and the library's answers, as one JavaScript array.
//
//   pane_values [--count=200] > expected.js

#include <opencv2/core.hpp>
#include <opencv2/refract.hpp>
#include <cmath>
#include <cstdio>

using namespace cv;
using refract::GlassWindow;

namespace {

const double BASE = 200;            // of the page's two cameras, mm
const Matx33d K(1200, 0, 639.5, 0, 1200, 511.5, 0, 0, 1);

struct Configuration
{
    double tilt, direction, tilt2, direction2, thickness, index, distance, outerIndex, wedge;
    Point3d point;
};

GlassWindow windowOf(const Configuration& c, double tilt, double direction)
{
    const double t = tilt*CV_PI/180, a = direction*CV_PI/180;
    GlassWindow window(Vec3d(std::sin(t)*std::cos(a), std::sin(t)*std::sin(a), std::cos(t)), c.thickness, c.index, c.distance,
                       c.outerIndex);
    if (c.wedge != 0)
        window.wedge = { Vec2d(c.wedge/60*CV_PI/180, 0) };
    return window;
}

Configuration randomConfiguration(RNG& rng, int i)
{
    Configuration c;
    c.tilt = i % 10 == 0 ? 0 : rng.uniform(0., 30.);
    c.direction = rng.uniform(0., 360.);
    c.tilt2 = i % 2 ? c.tilt : rng.uniform(0., 30.);
    c.direction2 = i % 2 ? c.direction + 180 : rng.uniform(0., 360.);
    c.thickness = rng.uniform(0.5, 50.);
    c.index = rng.uniform(1.3, 1.9);
    c.distance = rng.uniform(10., 80.);
    c.outerIndex = i % 4 < 2 ? 1 : i % 4 == 2 ? 1.333 : rng.uniform(1., 1.5);
    c.wedge = i % 3 == 0 ? 0 : rng.uniform(-30., 30.);
    c.point = Point3d(rng.uniform(-150., 350.), rng.uniform(-200., 200.), rng.uniform(300., 1200.));
    return c;
}

Point2d project(const Point3d& point, const Vec3d& T, const GlassWindow& window)
{
    std::vector<Point2d> pixels;
    refract::refractiveProjectPoints(std::vector<Point3d>(1, point), Vec3d(), T, K, noArray(), window, pixels);
    return pixels[0];
}

double epipolarDistance(const Point2d& pixel1, const GlassWindow& window1, const Point2d& pixel2, const GlassWindow& window2)
{
    std::vector<double> distances;
    refract::refractiveEpipolarDistance(std::vector<Point2d>(1, pixel1), std::vector<Point2d>(1, pixel2), K, noArray(), window1,
                                        K, noArray(), window2, Matx33d::eye(), Vec3d(-BASE, 0, 0), distances);
    return distances[0];
}

void print(const char* key, const std::vector<double>& values)
{
    std::printf(" %s: [", key);
    for (size_t i = 0; i < values.size(); i++)
        if (std::isnan(values[i]))
            std::printf("%sNaN", i ? ", " : "");
        else
            std::printf("%s%.17g", i ? ", " : "", values[i]);
    std::printf("],");
}

//! Where the curve of pixel1's partners passes at some depths: its ray meets planes, camera 2 sees the points.
std::vector<double> curvePixels(const Point2d& pixel1, const GlassWindow& window1, const GlassWindow& window2)
{
    std::vector<double> values;
    for (double z : { 300., 450., 700., 1200. })
    {
        std::vector<Point3d> points;
        refract::refractivePointsOnPlane(std::vector<Point2d>(1, pixel1), points, K, noArray(), window1, Vec4d(0, 0, 1, z));
        const Point2d pixel = project(points[0], Vec3d(-BASE, 0, 0), window2);
        values.insert(values.end(), { z, pixel.x, pixel.y });
    }
    return values;
}

void printAnswers(const Configuration& c)
{
    const GlassWindow window1 = windowOf(c, c.tilt, c.direction), window2 = windowOf(c, c.tilt2, c.direction2), none;
    const Vec3d T(-BASE, 0, 0);
    const Point2d pixel1 = project(c.point, Vec3d(), window1), pixel2 = project(c.point, T, window2);
    const Point2d pinhole1 = project(c.point, Vec3d(), none), pinhole2 = project(c.point, T, none);
    std::vector<Point3d> origin, direction, ignored;
    const std::vector<Point2d> pixels1(1, pixel1), pixels2(1, pixel2);
    refract::refractiveUnprojectPoints(pixels1, origin, direction, K, noArray(), window1);
    refract::triangulateRefractive(K, noArray(), none, K, noArray(), none, Matx33d::eye(), T, pixels1, pixels2, ignored);
    const Point3d o = origin[0], d = direction[0], i = ignored[0];
    print("pixel1", { pixel1.x, pixel1.y });
    print("pixel2", { pixel2.x, pixel2.y });
    print("pinhole1", { pinhole1.x, pinhole1.y });
    print("pinhole2", { pinhole2.x, pinhole2.y });
    if (c.wedge == 0)           // else any point of the ray near the axis will do
        print("origin", { o.x, o.y, o.z });
    print("direction", { d.x, d.y, d.z });
    print("curve", curvePixels(pixel1, window1, window2));
    print("ignored", { i.x, i.y, i.z });
    print("distance", { std::abs(epipolarDistance(pixel1, none, pixel2, none)) });
}

} // namespace

int main(int argc, char** argv)
{
    const CommandLineParser args(argc, argv, "{count | 200 | configurations}");
    RNG rng(16);
    std::printf("const EXPECTED = [\n");
    for (int i = 0; i < args.get<int>("count"); i++)
    {
        const Configuration c = randomConfiguration(rng, i);
        std::printf("{ input: { tilt: %.17g, direction: %.17g, tilt2: %.17g, direction2: %.17g, thickness: %.17g, index: %.17g, "
                    "distance: %.17g, outerIndex: %.17g, wedge: %.17g, x: %.17g, y: %.17g, z: %.17g },",
                    c.tilt, c.direction, c.tilt2, c.direction2, c.thickness, c.index, c.distance, c.outerIndex, c.wedge,
                    c.point.x, c.point.y, c.point.z);
        printAnswers(c);
        std::printf(" },\n");
    }
    std::printf("];\n");
    return 0;
}
