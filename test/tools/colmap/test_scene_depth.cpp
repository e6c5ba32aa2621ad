// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Depth between points, and the pinhole nearest to a camera with a window.
#include "colmap/scene_depth.hpp"
#include "scenes.hpp"
#include <catch2/catch.hpp>

using namespace cv;

TEST_CASE("Depth between the points of a plane is that of the plane", "[colmap]")
{
    CAPTURE(scenes::seed());
    scenes::Random random(71);
    const Size size(320, 250);
    const auto truth = [](double x, double y) { return 1/(1e-3 + 1e-6*x - 2e-6*y); };
    std::vector<Point2d> pixels;
    std::vector<double> depths;
    for (int i = 0; i < 40; i++)
    {
        pixels.push_back({random.uniform(0, 200), random.uniform(0, 249)});         // none at the right
        depths.push_back(truth(pixels.back().x, pixels.back().y));
    }
    for (const Point2d& corner : {Point2d(0, 0), Point2d(319, 0), Point2d(0, 249), Point2d(319, 249)})
    {
        pixels.push_back(corner);
        depths.push_back(truth(corner.x, corner.y));
    }
    const Mat_<double> depth = tools::sceneDepth(pixels, depths, size);
    REQUIRE(depth.size() == size);
    double worst = 0;
    for (int y = 0; y < size.height; y++)
        for (int x = 0; x < size.width; x++)
            worst = std::max(worst, std::abs(depth(y, x)/truth(x, y) - 1));
    CHECK(worst < 1e-9);
}

TEST_CASE("One point near the camera does not bend the depth of the others", "[colmap]")
{
    CAPTURE(scenes::seed());
    scenes::Random random(72);
    const Size size(320, 250);
    std::vector<Point2d> pixels;
    std::vector<double> depths;
    for (int i = 0; i < 60; i++)
    {
        pixels.push_back({random.uniform(0, 319), random.uniform(0, 249)});
        depths.push_back(1/(1e-3 + 1e-6*pixels.back().x));
    }
    for (const Point2d& near : {Point2d(-1, 0), Point2d(0.4, -0.3)})        // beside another, as if it were one keypoint
    {
        pixels.push_back(pixels[20] + near);
        depths.push_back(depths[20]);
    }
    pixels.push_back(pixels[20]);
    depths.push_back(1e-7);
    pixels.push_back({1e300, -1e300});
    depths.push_back(1000);
    const Mat_<double> depth = tools::sceneDepth(pixels, depths, size);
    for (int x : {20, 160, 300})
        CHECK(depth(125, x) == Approx(1/(1e-3 + 1e-6*x)).epsilon(0.02));
}

TEST_CASE("Depth follows what stands out of a plane, and stays between the points", "[colmap]")
{
    const Size size(320, 256);
    std::vector<Point2d> pixels;
    std::vector<double> depths;
    for (int y = 4; y < size.height; y += 8)
        for (int x = 4; x < size.width; x += 8)
        {
            pixels.push_back(Point2d(x, y));
            depths.push_back(x > 160 ? 500 : 1000);
        }
    const Mat_<double> depth = tools::sceneDepth(pixels, depths, size);
    CHECK(depth(128, 300) == Approx(500).epsilon(0.1));
    CHECK(depth(128, 20) == Approx(1000).epsilon(0.1));
    double least, most;
    minMaxLoc(depth, &least, &most);
    CHECK(least >= 500 - 1e-9);
    CHECK(most <= 1000 + 1e-9);
    const Mat_<double> ofOne = tools::sceneDepth({Point2d(3, 4)}, {700}, size);
    CHECK(ofOne(200, 300) == Approx(700));
}

TEST_CASE("The pinhole nearest to a camera is the camera itself where it has no window", "[colmap]")
{
    CAPTURE(scenes::seed());
    scenes::Random random(72);
    const Matx33d K(800, 0, 320, 0, 790, 240, 0, 0, 1);
    const auto plain = refract::RefractiveCamera::create(K, std::vector<double>{-0.1, 0.05, 1e-3, 0});
    const auto behind = refract::RefractiveCamera::create(K, std::vector<double>{-0.1, 0.05, 1e-3, 0},
                                                          refract::GlassWindow(Vec3d(0, 0, 1), 10, 1.49, 40, 1.333));
    std::vector<Point3d> points;
    for (int i = 0; i < 300; i++)
    {
        const double z = random.uniform(500, 800);
        points.push_back({z*random.uniform(-0.25, 0.25), z*random.uniform(-0.2, 0.2), z});
    }
    const tools::NearestPinhole same = tools::nearestPinhole(plain, points), other = tools::nearestPinhole(behind, points);
    CHECK(same.max < 1e-6);
    CHECK(norm(same.camera->lensParameters() - plain->lensParameters(), NORM_INF) < 1e-4);
    CHECK(other.rms > 0.01);
    CHECK(other.rms < 2);
    CHECK(other.camera->lensParameters().at<double>(0) > 1.2*800);
}
