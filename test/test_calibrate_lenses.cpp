// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A window found through lenses of mrcal, from corners that were simulated.
#include "calibration_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

TEST_CASE("The window is found behind lenses of mrcal", "[calibrate_lenses]")
{
    const std::string lens = GENERATE("quadratic splines", "cubic splines", "CAHVOR", "stereographic", "latlon");
    const double sigma = GENERATE(0., 0.1);
    CAPTURE(lens, sigma, seed());
    const LensKind& kind = lensNamed(lens);
    Random random;
    const GlassWindow truth(Vec3d(0.2, -0.1, 1), 20, 1.5437, 50, 1.333);
    const CalibrationScene scene = makeScene(makeCamera(kind, truth), 8, random, sigma);
    // Without direct images, from a start that is wrong.
    const Ptr<RefractiveCamera> camera = makeCamera(kind, GlassWindow(Vec3d(0, 0, 1), 20, 1.5437, 80, 1.333));
    std::vector<Vec3d> rvecs, tvecs;
    Mat deviations;
    const double rms = calibrateGlass(scene.object, std::vector<Mat>(), scene.refracted, camera, rvecs, tvecs, deviations, noArray(),
                                      noArray(), noArray(), GLASS_FREE_DISTANCE);
    const std::vector<String> names = camera->parameterNames();
    const int normal = (int)(std::find(names.begin(), names.end(), "normal[0]") - names.begin());
    const Vec3d n = camera->window().normal, expected = truth.normal*(1/norm(truth.normal));
    CHECK(rms < 2*sigma + 1e-6);
    for (int k = 0; k < 3; k++)
        CHECK(std::abs(n[k] - expected[k]) <= 5*deviations.at<double>(normal + k) + 1e-7);
    CHECK(std::abs(camera->window().distance - 50) <= 5*deviations.at<double>(normal + 3) + 1e-5);
}

TEST_CASE("Splines stay as they are where lenses are free", "[calibrate_lenses]")
{
    CAPTURE(seed());
    Random random;
    const LensKind& kind = lensNamed("cubic splines");
    const CalibrationScene scene = makeScene(makeCamera(kind, paper::pane()), 8, random, 0.1);
    const Ptr<RefractiveCamera> camera = makeCamera(kind, GlassWindow(Vec3d(0, 0, 1), 20, 1.5437, 50));
    std::vector<Vec3d> rvecs, tvecs;
    Mat deviations;
    calibrateGlass(scene.object, scene.direct, scene.refracted, camera, rvecs, tvecs, deviations, noArray(), noArray(), noArray(),
                   GLASS_FREE_INTRINSICS);
    CHECK(largestDifference(camera->lensParameters(), kind.parameters()) == 0);
    CHECK(largestDifference(camera->distCoeffs(), kind.coefficients) == 0);
    CHECK(countNonZero(deviations.rowRange(0, 4)) == 0);
    const Vec3d n = camera->window().normal, truth = normalize(paper::pane().normal);
    for (int k = 0; k < 3; k++)
        CHECK(std::abs(n[k] - truth[k]) <= 5*deviations.at<double>(4 + k) + 1e-9);
}

TEST_CASE("The other lenses of mrcal are refined", "[calibrate_lenses]")
{
    CAPTURE(seed());
    Random random;
    LensKind kind = lensNamed("CAHVORE, sine");
    const CalibrationScene scene = makeScene(makeCamera(kind, paper::pane()), 10, random, 0.1);
    kind.K(0, 0) *= 1.005;
    kind.coefficients[2] += 0.005;
    const Ptr<RefractiveCamera> camera = makeCamera(kind, paper::pane());
    std::vector<Vec3d> rvecs, tvecs;
    Mat deviations;
    calibrateGlass(scene.object, scene.direct, scene.refracted, camera, rvecs, tvecs, deviations, noArray(), noArray(), noArray(),
                   GLASS_FREE_INTRINSICS);
    const Mat found = camera->lensParameters();
    const std::vector<double> truth = lensNamed("CAHVORE, sine").parameters();
    REQUIRE(found.total() == 9);        // e0, e1, e2 are none
    for (int i = 0; i < 9; i++)
    {
        CAPTURE(i, found.at<double>(i), truth[i], deviations.at<double>(i));
        CHECK(std::abs(found.at<double>(i) - truth[i]) <= 5*deviations.at<double>(i));
    }
}
