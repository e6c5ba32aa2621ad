// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Pixel -> ray -> point on the ray -> pixel, a million random configurations.
#include "scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

/* Largest angle from the normal, in the medium of smallest index on the way. Where that is a gap between the panes, the
ray's origin runs away like 1/cos, and a rounding of the pixel moves it by 1/cos^2. */
double largestAngle(const GlassWindow& w)
{
    const bool gap = !w.index.empty()
                     && *std::min_element(w.index.begin(), w.index.end()) < std::min(w.innerIndex, w.outerIndex);
    return (gap ? 89.5 : 89.9)*CV_PI/180;
}

double smallestIndex(const GlassWindow& w)
{
    double least = std::min(w.innerIndex, w.outerIndex);
    for (double n : w.index)
        least = std::min(least, n);
    return least;
}

double totalHeight(const GlassWindow& w)
{
    double total = w.distance;
    for (double t : w.thickness)
        total += t;
    return total;
}

//! Pixels of a camera, and for each the sine of its ray's angle in the window's rarest medium; > 1: total reflection.
struct Pixels
{
    std::vector<Vec2d> pixel;
    std::vector<double> sine;
};

/* Pixels within the lens's field whose rays meet the window at up to 89.9 degrees, evenly in the angle, so that grazing
rays are as many as steep ones. */
Pixels somePixels(const LensKind& lens, const GlassWindow& window, int count, Random& random)
{
    const Ptr<RefractiveCamera> plain = makeCamera(lens, GlassWindow());
    const Vec3d n = window.normal, across = normalize(n.cross(Vec3d(0.36, 0.48, -0.8))), third = n.cross(across);
    const double ratio = window.innerIndex/smallestIndex(window), most = largestAngle(window);
    std::vector<Vec3d> directions;
    Pixels result;
    for (int i = 0; i < 20*count && (int)directions.size() < count; i++)
    {
        const double angle = random.uniform(0, most), azimuth = random.uniform(0, 2*CV_PI);
        const Vec3d w = std::cos(angle)*n + std::sin(angle)*(std::cos(azimuth)*across + std::sin(azimuth)*third);
        const double sine = ratio*std::sin(angle);
        if (w[2] < std::cos(lens.halfField*CV_PI/180) || (sine > std::sin(most) && sine < 1.0001))
            continue;
        directions.push_back(w);
        result.sine.push_back(sine);
    }
    refractiveProjectPoints(directions, Vec3d(), Vec3d(), plain, result.pixel);
    return result;
}

struct Worst { double pixel = 0, miss = 0; int configurations = 0, reflected = 0; };

//! One camera; returns a description of the first failure, or "".
std::string roundTrip(const Ptr<RefractiveCamera>& camera, const Pixels& pixels, Random& random, Worst& worst)
{
    const GlassWindow window = camera->window();
    std::vector<Vec3d> origins, directions;
    std::vector<uchar> status, statusBack;
    refractiveUnprojectPoints(pixels.pixel, origins, directions, camera, status);
    std::vector<Vec3d> points, known;
    std::vector<size_t> source;
    for (size_t i = 0; i < pixels.pixel.size(); i++)
    {
        const bool reflected = pixels.sine[i] > 1;
        if (status[i] != (reflected ? REFRACT_TOTAL_REFLECTION : REFRACT_OK))
            return format("pixel (%.17g, %.17g): status %d, sine %.17g", pixels.pixel[i][0], pixels.pixel[i][1], status[i],
                          pixels.sine[i]);
        worst.reflected += reflected;
        if (reflected)
            continue;
        // Beyond the last surface, where the ray is the light's path.
        const double c = window.normal.dot(directions[i]), leaves = (totalHeight(window) - window.normal.dot(origins[i]))/c;
        points.push_back(origins[i] + (leaves + random.logUniform(1, 1e5))*directions[i]);
        source.push_back(i);
    }
    std::vector<Vec2d> back;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, back, statusBack);
    for (size_t k = 0; k < points.size(); k++)
    {
        const size_t i = source[k];
        const double error = norm(back[k] - pixels.pixel[i]);
        if (statusBack[k] != REFRACT_OK || !(error < 1e-9))
            return format("pixel (%.17g, %.17g): status %d back, %g px off, sine %.17g", pixels.pixel[i][0],
                          pixels.pixel[i][1], statusBack[k], error, pixels.sine[i]);
        worst.pixel = std::max(worst.pixel, error);
    }
    worst.configurations += (int)pixels.pixel.size();

    // The ray of a projected point passes the point.
    refractiveUnprojectPoints(back, origins, directions, camera, status);
    for (size_t k = 0; k < points.size(); k++)
    {
        const Vec3d offset = points[k] - origins[k];
        worst.miss = std::max(worst.miss, norm(offset.cross(directions[k]))/norm(offset));
        if (status[k] != REFRACT_OK)
            return format("unprojection of a projected point: status %d", status[k]);
    }
    return "";
}

} // namespace

TEST_CASE("A million round trips up to 89.9 degrees, in every window and lens", "[round_trip]")
{
    CAPTURE(seed());
    Random random;
    Worst total;
    for (WindowKind kind : parallelWindows())
    {
        Worst worst;
        for (int scene = 0; scene < 1400; scene++)
        {
            const LensKind& lens = allLenses()[scene % allLenses().size()];
            const GlassWindow window = makeWindow(kind, random, 60);
            const Pixels pixels = somePixels(lens, window, 100, random);
            CAPTURE(name(kind), lens.name, scene, window.normal, window.distance);
            const std::string failure = roundTrip(makeCamera(lens, window), pixels, random, worst);
            CAPTURE(failure);
            REQUIRE(failure == "");
        }
        CAPTURE(name(kind));
        CHECK(worst.miss < 1e-11);
        const bool canReflect = kind == WATER_GLASS_AIR || kind == DOUBLE_GLAZING_IN_WATER;
        CHECK((worst.reflected > 1000) == canReflect);
        total.pixel = std::max(total.pixel, worst.pixel);
        total.miss = std::max(total.miss, worst.miss);
        total.configurations += worst.configurations;
        total.reflected += worst.reflected;
    }
    CHECK(total.configurations > 1000000);
    printNumber("round trips, of which totally reflected " + std::to_string(total.reflected), total.configurations, "");
    printNumber("round trip, worst", total.pixel, "px");
    printNumber("ray's miss of the true point, worst share of its range", total.miss, "");
}

TEST_CASE("Points on a grid of angles up to the horizon come back", "[round_trip]")
{
    // Every degree of grazing in the rarest medium, down to a thousandth, at every depth.
    const LensKind& lens = lensNamed("fisheye");
    CAPTURE(seed());
    Random random;
    for (WindowKind kind : parallelWindows())
    {
        GlassWindow window = makeWindow(kind, random, 0);
        const Ptr<RefractiveCamera> camera = makeCamera(lens, window), plain = makeCamera(lens, GlassWindow());
        for (double degrees : { 0., 1e-9, 1e-3, 1., 45., 80., 85., 89., 89.5, 89.9 })
        {
            const double sine = std::sin(degrees*CV_PI/180)*smallestIndex(window)/window.innerIndex;
            std::vector<Vec2d> pixel, back;
            std::vector<Vec3d> origin, direction;
            std::vector<uchar> status;
            refractiveProjectPoints(std::vector<Vec3d>{ { 0.6*sine, -0.8*sine, std::sqrt(1 - sine*sine) } }, Vec3d(), Vec3d(),
                                    plain, pixel);
            refractiveUnprojectPoints(pixel, origin, direction, camera, status);
            CAPTURE(name(kind), degrees);
            REQUIRE(status[0] == REFRACT_OK);
            for (double beyond : { 1e-6, 1e-2, 1., 1e3, 1e7 })
            {
                const double height = totalHeight(window) + beyond;
                const Vec3d X = origin[0] + (height - origin[0][2])/direction[0][2]*direction[0];
                refractiveProjectPoints(std::vector<Vec3d>{ X }, Vec3d(), Vec3d(), camera, back, status);
                CAPTURE(beyond, X);
                REQUIRE(status[0] == REFRACT_OK);
                CHECK(norm(back[0] - pixel[0]) < 1e-9);
            }
        }
    }
}
