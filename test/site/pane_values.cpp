// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What doc/pane.html should compute: random configurations of it, as many of each shape of window, and the library's answers, as one
// JavaScript array. A camera that is not inside its window, which the library refuses, has the status -1.
//
//   pane_values [--count=200] [--seed=16] > expected.js

#include <opencv2/core.hpp>
#include <opencv2/refract.hpp>
#include <cmath>
#include <cstdio>

using namespace cv;
using refract::GlassWindow;

namespace {

const double BASE = 200;            // of the page's two cameras, mm
const Matx33d K(1200, 0, 639.5, 0, 1200, 511.5, 0, 0, 1);
const char* const SHAPES[] = { "flat", "dome", "tube" };
const int NOT_INSIDE = -1;

//! Where a window is, of all shapes. Angles in degrees.
struct Place
{
    double tilt, direction;
    Vec3d center;
    double turn, lean, ahead, beside;
};

struct Configuration
{
    int shape;
    Place first, second;
    bool isTurned;              //!< the second, as the page does it by itself
    double distance, wedge, radius, thickness, index, innerIndex, outerIndex;
    Point3d point;
};

double radians(double degrees) { return degrees*CV_PI/180; }

GlassWindow paneOf(const Configuration& c, const Place& place)
{
    const double t = radians(place.tilt), a = radians(place.direction);
    GlassWindow window(Vec3d(std::sin(t)*std::cos(a), std::sin(t)*std::sin(a), std::cos(t)), c.thickness, c.index, c.distance,
                       c.outerIndex);
    if (c.wedge != 0)
        window.wedge = { Vec2d(radians(c.wedge/60), 0) };
    return window;
}

GlassWindow tubeOf(const Configuration& c, const Place& place)
{
    const double t = radians(place.turn), l = radians(place.lean);
    const Vec3d axis(std::cos(l)*std::cos(t), std::cos(l)*std::sin(t), std::sin(l));
    const Vec3d forward = normalize(Vec3d(0, 0, 1) - axis[2]*axis);
    return GlassWindow::tube(place.ahead*forward + place.beside*axis.cross(forward), axis, c.radius, c.thickness, c.index, c.outerIndex);
}

//! false: the library refuses it.
bool makeWindow(const Configuration& c, const Place& place, GlassWindow& window)
{
    try
    {
        window = c.shape == 0 ? paneOf(c, place) : c.shape == 2 ? tubeOf(c, place)
                 : GlassWindow::dome(place.center, c.radius, c.thickness, c.index, c.outerIndex);
    }
    catch (const Exception&)
    {
        return false;
    }
    window.innerIndex = c.innerIndex;
    return true;
}

//! Anywhere in and about a window of the radius, most of them well inside.
Place randomPlace(RNG& rng, int i, double radius)
{
    const double offset = i % 8 == 0 ? 1.1*radius : i % 8 == 1 ? 0 : 0.55*radius;
    Place place;
    place.tilt = i % 10 == 0 ? 0 : rng.uniform(0., 30.);
    place.direction = rng.uniform(0., 360.);
    place.center = Vec3d(rng.uniform(-1., 1.), rng.uniform(-1., 1.), rng.uniform(-1., 1.))*offset;
    place.turn = i % 6 == 0 ? 90 : rng.uniform(0., 180.);
    place.lean = i % 3 == 0 ? rng.uniform(-80., 80.) : rng.uniform(-20., 20.);
    place.ahead = rng.uniform(-1., 1.)*offset;
    place.beside = rng.uniform(-1., 1.)*offset;
    return place;
}

//! Half round about the line of sight.
Place turned(Place place)
{
    place.direction += 180;
    place.center = Vec3d(-place.center[0], -place.center[1], place.center[2]);
    place.turn += 180;
    return place;
}

Configuration randomConfiguration(RNG& rng, int shape, int i)
{
    Configuration c;
    c.shape = shape;
    c.radius = rng.uniform(15., 150.);
    c.first = randomPlace(rng, i, c.radius);
    c.isTurned = i % 2 == 1;
    c.second = c.isTurned ? turned(c.first) : randomPlace(rng, i/2, c.radius);
    c.thickness = rng.uniform(0.5, 50.);
    c.index = rng.uniform(1.3, 1.9);
    c.distance = rng.uniform(10., 80.);
    c.outerIndex = i % 4 < 2 ? 1 : i % 4 == 2 ? 1.333 : rng.uniform(1., 1.5);
    c.innerIndex = i % 5 < 3 ? 1 : i % 5 == 3 ? 1.333 : rng.uniform(1., 1.5);
    c.wedge = i % 3 == 0 ? 0 : rng.uniform(-30., 30.);
    c.point = Point3d(rng.uniform(-150., 350.), rng.uniform(-200., 200.), rng.uniform(300., 1200.));
    return c;
}

Point2d project(const Point3d& point, const Vec3d& T, const GlassWindow& window, int* status = nullptr)
{
    std::vector<Point2d> pixels;
    std::vector<uchar> reasons;
    refract::refractiveProjectPoints(std::vector<Point3d>(1, point), Vec3d(), T, K, noArray(), window, pixels, reasons);
    if (status)
        *status = reasons[0];
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

void printPlace(const Place& p)
{
    std::printf(" tilt: %.17g, direction: %.17g, centerX: %.17g, centerY: %.17g, centerZ: %.17g, turn: %.17g, lean: %.17g, ahead: %.17g, "
                "beside: %.17g", p.tilt, p.direction, p.center[0], p.center[1], p.center[2], p.turn, p.lean, p.ahead, p.beside);
}

void printInput(const Configuration& c)
{
    std::printf(" input: { shape: \"%s\",", SHAPES[c.shape]);
    printPlace(c.first);
    if (!c.isTurned)
    {
        std::printf(", second: {");
        printPlace(c.second);
        std::printf(" }");
    }
    std::printf(", distance: %.17g, wedge: %.17g, radius: %.17g, thickness: %.17g, index: %.17g, innerIndex: %.17g, outerIndex: %.17g, "
                "x: %.17g, y: %.17g, z: %.17g },", c.distance, c.wedge, c.radius, c.thickness, c.index, c.innerIndex, c.outerIndex,
                c.point.x, c.point.y, c.point.z);
}

/** Where the curve of pixel1's partners passes at some depths: its ray meets planes, camera 2 sees the points. A plane may also meet the
ray's line where it has not left a tube yet, on the tube's other side; camera 1 sees such a point elsewhere. */
void printCurve(const Point2d& pixel1, const GlassWindow& window1, const GlassWindow& window2)
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<double> depths = { 300., 450., 700., 1200. };
    std::vector<double> values, statuses;
    for (double z : depths)
    {
        std::vector<Point3d> points;
        std::vector<uchar> met;
        refract::refractivePointsOnPlane(std::vector<Point2d>(1, pixel1), points, K, noArray(), window1, Vec4d(0, 0, 1, z), met);
        int status = met[0] != refract::REFRACT_OK ? refract::REFRACT_BEHIND_WINDOW : refract::REFRACT_OK;
        Point2d pixel(nan, nan);
        if (status == refract::REFRACT_OK)
            pixel = project(points[0], Vec3d(-BASE, 0, 0), window2, &status);
        values.insert(values.end(), { pixel.x, pixel.y });
        statuses.push_back(status);
    }
    print("depths", depths);
    print("curve", values);
    print("curveStatus", statuses);
}

void printRay(const Point2d& pixel1, const GlassWindow& window1)
{
    std::vector<Point3d> origin, direction;
    refract::refractiveUnprojectPoints(std::vector<Point2d>(1, pixel1), origin, direction, K, noArray(), window1);
    const Point3d o = origin[0], d = direction[0];
    print("origin", { o.x, o.y, o.z });
    print("direction", { d.x, d.y, d.z });
}

//! What two cameras without windows make of the pixels.
void printIgnored(const Point2d& pixel1, const Point2d& pixel2)
{
    const GlassWindow none;
    std::vector<Point3d> points;
    refract::triangulateRefractive(K, noArray(), none, K, noArray(), none, Matx33d::eye(), Vec3d(-BASE, 0, 0),
                                   std::vector<Point2d>(1, pixel1), std::vector<Point2d>(1, pixel2), points);
    print("ignored", { points[0].x, points[0].y, points[0].z });
    print("distance", { std::abs(epipolarDistance(pixel1, none, pixel2, none)) });
}

void printAnswers(const Configuration& c)
{
    const Vec3d T(-BASE, 0, 0);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    GlassWindow window1, window2;
    const bool isInside1 = makeWindow(c, c.first, window1), isInside2 = makeWindow(c, c.second, window2);
    int status1 = NOT_INSIDE, status2 = NOT_INSIDE;
    const Point2d pixel1 = isInside1 ? project(c.point, Vec3d(), window1, &status1) : Point2d(nan, nan);
    const Point2d pixel2 = isInside2 ? project(c.point, T, window2, &status2) : Point2d(nan, nan);
    const Point2d pinhole1 = project(c.point, Vec3d(), GlassWindow()), pinhole2 = project(c.point, T, GlassWindow());
    print("status", { double(status1), double(status2) });
    print("pixel1", { pixel1.x, pixel1.y });
    print("pixel2", { pixel2.x, pixel2.y });
    print("pinhole1", { pinhole1.x, pinhole1.y });
    print("pinhole2", { pinhole2.x, pinhole2.y });
    if (status1 == refract::REFRACT_OK)
        printRay(pixel1, window1);
    if (status1 == refract::REFRACT_OK && isInside2)
        printCurve(pixel1, window1, window2);
    printIgnored(pixel1, pixel2);
}

} // namespace

int main(int argc, char** argv)
{
    const CommandLineParser args(argc, argv, "{count | 200 | configurations of each shape}{seed | 16 | of the random numbers}");
    const int seed = args.get<int>("seed");
    RNG rng(seed);
    std::printf("const SEED = %d, EXPECTED = [\n", seed);
    for (int shape = 0; shape < 3; shape++)
        for (int i = 0; i < args.get<int>("count"); i++)
        {
            const Configuration c = randomConfiguration(rng, shape, i);
            std::printf("{");
            printInput(c);
            printAnswers(c);
            std::printf(" },\n");
        }
    std::printf("];\n");
    return 0;
}
