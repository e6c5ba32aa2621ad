// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The normal of a window by the planes of its rays, of which nothing else is known.
#include "start/coplanarity.hpp"
#include "calibration_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

RigViews viewsOf(const CalibrationScene& scene)
{
    RigViews views;
    views.object = scene.object;
    views.cameras.resize(1);
    views.cameras[0].refracted = scene.refracted;
    views.cameras[0].direct.resize(scene.object.size());
    return views;
}

GlassWindow tilted(double tilt, double azimuth, double thickness, double index, double distance)
{
    const Vec3d normal(std::sin(tilt)*std::cos(azimuth), std::sin(tilt)*std::sin(azimuth), std::cos(tilt));
    return GlassWindow(normal, thickness, index, distance, 1.333);
}

} // namespace

TEST_CASE("Planes of rays tell the normal, whatever is in front and how far it is", "[coplanarity]")
{
    double largest = 0;
    for (double thickness : { 1e-3, 4., 60. })
        for (double distance : { 40., 150., 300. })
            for (bool flat : { true, false })
                for (double tilt : { 0.05, 0.4, 0.7 })
                {
                    Random random(71);
                    const GlassWindow window = tilted(tilt, random.uniform(0, 2*CV_PI), thickness, 1.49, distance);
                    const Ptr<RefractiveCamera> camera = paperCamera(window);
                    const ObjectViews targets = flat ? ObjectViews(6, board()) : ObjectViews(2, cloud(random));
                    RigViews views = viewsOf(makeScene(camera, targets, random, 0, 1000, 1200));
                    views.cameras[0].refracted[0][3] = Point2d(NaN, NaN);
                    views.cameras[0].refracted[0][4].x = NaN;
                    const GlassWindow other(Vec3d(0, 0, 1), 10, 1.6, 33, 1.2);
                    const std::vector<Vec3d> normals = normalsByCoplanarity(cameraOf(paperCamera(other)), views);
                    CAPTURE(thickness, distance, flat, tilt, seed());
                    REQUIRE_FALSE(normals.empty());
                    largest = std::max(largest, angleBetween(normals[0], window.normal));
                    CHECK(angleBetween(normals[0], window.normal) < 0.02);
                }
    printNumber("Normals by coplanarity, perfect data, largest error", largest, "degrees");
}

TEST_CASE("Views of too few points, or of points on a line, tell no normal", "[coplanarity]")
{
    Random random(72);
    const Ptr<RefractiveCamera> camera = paperCamera(tilted(0.4, 1, 4, 1.49, 100));
    RigViews views = viewsOf(makeScene(camera, ObjectViews(3, board(5, 1)), random, 0, 700, 900));
    CHECK(normalsByCoplanarity(cameraOf(camera), views).empty());
    views = viewsOf(makeScene(camera, ObjectViews(3, board(2, 2)), random, 0, 700, 900));
    CHECK(normalsByCoplanarity(cameraOf(camera), views).empty());
    views = viewsOf(makeScene(camera, ObjectViews(3, board()), random, 0, 700, 900));
    for (std::vector<Point2d>& pixels : views.cameras[0].refracted)
        pixels.assign(pixels.size(), Point2d(NaN, NaN));
    CHECK(normalsByCoplanarity(cameraOf(camera), views).empty());
    for (std::vector<Point2d>& pixels : views.cameras[0].refracted)
        pixels.clear();
    CHECK(normalsByCoplanarity(cameraOf(camera), views).empty());
}
