// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Which control points a splined lens's pixel depends on, through the public call: against differences, and where there is none.
#include "scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const char* const MODELS[] = { "LENSMODEL_SPLINED_STEREOGRAPHIC_order=2_Nx=9_Ny=8_fov_x_deg=110",
                               "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=9_Ny=8_fov_x_deg=110" };

std::vector<double> intrinsicsOf(Random& random)
{
    std::vector<double> all = { 600, 605, 320, 240 };
    for (int i = 0; i < 2*9*8; i++)
        all.push_back(random.normal(0.01));
    return all;
}

} // namespace

TEST_CASE("Weights of control points behind a window are the pixel's differences", "[spline_weights]")
{
    CAPTURE(seed());
    Random random;
    const String model = MODELS[GENERATE(0, 1)];
    const std::vector<double> intrinsics = intrinsicsOf(random);
    const GlassWindow window(Vec3d(0.05, -0.1, 1), 12, 1.5, 40, 1.333);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createMrcal(model, intrinsics, window);
    const Vec3d rvec(0.1, -0.05, 0.2), tvec(5, -8, 100);
    std::vector<Point3d> points;
    for (int i = 0; i < 60; i++)
    {
        const double x = random.uniform(-200, 200), y = random.uniform(-150, 150);
        points.emplace_back(x, y, random.uniform(400, 900));
    }
    Mat controls, weights;
    std::vector<uchar> status;
    refractiveSplineWeights(points, rvec, tvec, camera, controls, weights, status);
    CHECK(controls.cols == (model.find("order=2") != String::npos ? 9 : 16));
    std::vector<Point2d> before, after;
    refractiveProjectPoints(points, rvec, tvec, camera, before);
    double worst = 0;
    for (int parameter = 4; parameter < (int)intrinsics.size(); parameter++)
    {
        const double STEP = 1e-4;       // the pixel is linear in it: no smaller one is better
        std::vector<double> moved = intrinsics;
        moved[parameter] += STEP;
        refractiveProjectPoints(points, rvec, tvec, RefractiveCamera::createMrcal(model, moved, window), after);
        const int axis = parameter % 2, control = (parameter - 4)/2;
        for (int i = 0; i < (int)points.size(); i++)
        {
            REQUIRE(status[i] == REFRACT_OK);
            double expected[2] = { 0, 0 };
            for (int k = 0; k < controls.cols; k++)
                if (controls.at<int>(i, k) == control)
                    expected[axis] += intrinsics[axis]*weights.at<double>(i, k);
            const Point2d change = (after[i] - before[i])*(1/STEP);
            worst = std::max({ worst, std::abs(change.x - expected[0]), std::abs(change.y - expected[1]) });
        }
    }
    CHECK(worst < 1e-6);        // px per unit, of up to 400
}

TEST_CASE("Points without a pixel have no control points, and lenses without control points throw", "[spline_weights]")
{
    using Catch::Matchers::Contains;
    Random random;
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createMrcal(MODELS[1], intrinsicsOf(random));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<Point3f> points = { Point3f(0, 0, 5), Point3f((float)nan, 0, 5), Point3f(0, 0, -5), Point3f(500, 0, 1) };
    Mat controls, weights;
    std::vector<uchar> status;
    refractiveSplineWeights(points, Vec3d(), Vec3d(), camera, controls, weights, status);
    CHECK(status == std::vector<uchar>{ REFRACT_OK, REFRACT_NOT_FINITE, REFRACT_OUTSIDE_LENS_MODEL, REFRACT_OUTSIDE_LENS_MODEL });
    CHECK(countNonZero(controls.row(0) >= 0) == 16);
    for (int i = 1; i < 4; i++)
    {
        CHECK(countNonZero(controls.row(i) == -1) == 16);
        CHECK(countNonZero(weights.row(i) != weights.row(i)) == 16);
    }
    refractiveSplineWeights(std::vector<Point3d>(), Vec3d(), Vec3d(), camera, controls, weights, status);
    CHECK(weights.rows == 0);
    const Ptr<RefractiveCamera> opencv = RefractiveCamera::create(Matx33d(600, 0, 320, 0, 600, 240, 0, 0, 1), noArray());
    CHECK_THAT(thrown([&] { refractiveSplineWeights(points, Vec3d(), Vec3d(), opencv, controls, weights); }),
               Contains("camera") && Contains("SPLINED_STEREOGRAPHIC"));
    CHECK_THAT(thrown([&] { refractiveSplineWeights(points, Vec3d(), Vec3d(), Ptr<RefractiveCamera>(), controls, weights); }),
               Contains("camera"));
}
