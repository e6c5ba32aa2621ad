// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The lens model that refract_calib chooses: between OpenCV's and cv::fisheye's, from direct images, or through the window.
#include "calibrate/fit.hpp"
#include "calibrate/lens_choice.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "scenes.hpp"
#include <catch2/catch.hpp>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

const Size IMAGE(1280, 1024);

//! Boards that fill much of the image.
RigData dataOf(const Ptr<RefractiveCamera>& camera, int views, bool glass, unsigned salt)
{
    scenes::Random random(salt);
    RigData data;
    data.imageSize[0] = IMAGE;
    const double range = 0.3*camera->cameraMatrix().at<double>(0, 0);
    while ((int)data.views.size() < views)
    {
        View view;
        for (int i = 0; i < 63; i++)
            view.objectPoints.emplace_back(40*(i % 9 - 4), 40*(i/9 - 3), 0);
        const Vec3d rvec = random.vector(0.35), tvec(random.uniform(-120, 120), random.uniform(-90, 90), random.uniform(range, 1.6*range));
        std::vector<Point2d> pixels;
        refractiveProjectPoints(view.objectPoints, rvec, tvec, camera, pixels);
        int inside = 0;
        for (Point2d& p : pixels)
        {
            p += Point2d(random.normal(0.2), random.normal(0.2));
            const bool isInside = Rect2d(Point2d(), Size2d(IMAGE)).contains(p);
            inside += isInside;
            if (!isInside)
                p = Point2d(NAN, NAN);
        }
        if (inside < 20)
            continue;
        (glass ? view.glass : view.direct)[0] = pixels;
        data.views.push_back(view);
    }
    return data;
}

Ptr<RefractiveCamera> bent(const GlassWindow& window = GlassWindow())
{
    return RefractiveCamera::create(Matx33d(1100, 0, 645, 0, 1103, 508, 0, 0, 1), std::vector<double>{-0.28, 0.09, 0, 0}, window);
}

} // namespace

TEST_CASE("A lens that k1 and k2 describe is chosen by its direct images, and said in one line", "[lens_choice]")
{
    RigOptions options;
    const RigData data = dataOf(bent(), 15, false, 1);
    const LensChoice choice = chooseLens(data, options, true);
    REQUIRE(!choice.scores.empty());
    CHECK(choice.lens().model == "opencv");
    CHECK(choice.lens().coefficients == 2);
    CHECK_THAT(choice.sentence(), Catch::StartsWith("opencv, 2 coefficients (k1, k2), chosen by held-out images: 0.2")
               && Catch::Contains("px; with 0: ") && Catch::Contains(", 1: ") && Catch::Contains(", 5: "));
    setLens(choice, options);
    CHECK(options.lensCoefficients == 4);
    CHECK(options.carriedCoefficients(0) == 5);         // what 15 images leave open of p1, p2 and k3 is in every +- that follows
    REQUIRE(options.leftOut.size() == 1);
    std::vector<LensSource> sources;
    const RigModel start = startModel(data, options, sources);
    CHECK(pinholeCoefficients(start, 0) == 4);
    const KnownCamera known = start.known[0];
    for (int i : {6, 7, 8})
    {
        CHECK(options.leftOut[0].at<double>(i, i) > 0.);
        CHECK(known.covariance.at<double>(i, i) == options.leftOut[0].at<double>(i, i));
        CHECK(known.lens.at<double>(i) == 0.);
    }
    CHECK(std::isnan(known.covariance.at<double>(4, 4)));       // k1 is as free as it was
    CHECK((options.flags & GLASS_FIX_TANGENT_DIST) != 0);
    CHECK((options.flags & (GLASS_FIX_K1 | GLASS_FIX_K2)) == 0);
}

TEST_CASE("A fit that holds the lens holds what the lens choice left out, too", "[lens_choice]")
{
    const GlassWindow window(Vec3d(0.12, -0.06, 1), 15, 1.52, 0);
    RigData data = dataOf(bent(), 12, false, 21);
    RigOptions options;
    options.window = window;
    options.window.normal = Vec3d(0, 0, 1);
    setLens(chooseLens(data, options, true), options);
    REQUIRE(options.carriedCoefficients(0) > options.lensCoefficients);
    const RigData behind = dataOf(bent(window), 9, true, 22);
    std::vector<int> through;
    for (const View& view : behind.views)
    {
        through.push_back((int)data.views.size());
        data.views.push_back(view);
    }
    std::vector<LensSource> sources;
    const RigModel start = startModel(data, options, sources);
    const Fit held = fitImages(data, start, through, options.flags);
    const int lens = start.cameras[0]->lensParameters().rows;
    CHECK(countNonZero(held.stdDeviations.rowRange(0, lens)) == 0);
    CHECK(countNonZero(held.stdDeviations.rowRange(lens, held.stdDeviations.rows)) > 0);
    CHECK(norm(held.rig.cameras[0]->lensParameters(), start.cameras[0]->lensParameters()) == 0);
    RigModel exact = start.clone();
    exact.known[0].covariance = Mat();
    const Fit plain = fitImages(data, exact, through, options.flags);
    CHECK(held.rms == Approx(plain.rms).epsilon(1e-9));
    CHECK(held.dof == plain.dof);
    // Free, it is what the images leave open.
    const Fit free = fitImages(data, start, allViews(data), options.flags | GLASS_FREE_INTRINSICS);
    CHECK(free.stdDeviations.at<double>(INTRINSICS + options.lensCoefficients) > 0.);
}

TEST_CASE("A lens that is chosen through the window is where the calibration starts", "[lens_choice]")
{
    GlassWindow water;
    water.normal = normalize(Vec3d(0.12, -0.06, 1));
    water.distance = 80;
    water.outerIndex = 1.333;
    const RigData data = dataOf(bent(water), 12, true, 23);
    RigOptions options;
    options.flags = GLASS_FREE_INTRINSICS | GLASS_FREE_DISTANCE;
    options.window = water;
    options.window.normal = Vec3d(0, 0, 1);
    options.window.distance = 40;
    const LensChoice choice = chooseLens(data, options, false);
    REQUIRE(!choice.scores.empty());
    REQUIRE(!choice.direct);
    CAPTURE(choice.sentence());
    const auto focalLength = [&]()
    {
        std::vector<LensSource> sources;
        const RigModel start = startModel(data, options, sources);
        CHECK(sources[0].kind == LensSource::FROM_GLASS);
        return start.cameras[0]->cameraMatrix().at<double>(0, 0);
    };
    options.lensCoefficients = 4;
    CHECK(focalLength() > 1.2*1100);            // a pinhole has taken up the water
    setLens(choice, options);
    CHECK(focalLength() == Approx(1100).epsilon(0.02));
}

TEST_CASE("A wide fisheye is chosen where OpenCV's model does not describe it", "[lens_choice]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createFisheye(Matx33d(400, 0, 645, 0, 402, 508, 0, 0, 1),
                                                                         std::vector<double>{-0.02, 0.006, -0.004, 0.0012});
    RigOptions options;
    const LensChoice choice = chooseLens(dataOf(camera, 20, false, 2), options, false);
    REQUIRE(!choice.scores.empty());
    CAPTURE(choice.sentence());
    CHECK(choice.lens().model == "fisheye");
    CHECK(choice.lens().px < 0.3);
    setLens(choice, options);
    CHECK(options.lensCoefficients == FISHEYE_LENS);
}

TEST_CASE("A fisheye is found in few images, in which OpenCV's many coefficients are not found", "[lens_choice]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createFisheye(Matx33d(560, 0, 645, 0, 563, 508, 0, 0, 1),
                                                                         std::vector<double>{-0.02, 0.006, -0.004, 0.0012});
    for (unsigned salt : {13, 28, 29})
    {
        const LensChoice choice = chooseLens(dataOf(camera, 6, false, salt), RigOptions(), false);
        REQUIRE(!choice.scores.empty());
        CAPTURE(salt, choice.sentence());
        CHECK(choice.lens().model == "fisheye");
    }
}

TEST_CASE("Three direct images are held out in parts", "[lens_choice]")
{
    const LensChoice choice = chooseLens(dataOf(bent(), 3, false, 3), RigOptions(), true);
    REQUIRE(!choice.scores.empty());
    CHECK_THAT(choice.sentence(), Catch::Contains("chosen by held-out parts of the target: "));
}

TEST_CASE("Images through the window decide where there is no other, and where the lens is to be found from them", "[lens_choice]")
{
    const GlassWindow window(Vec3d(0.1, -0.05, 1), 20, 1.52, 0);
    const RigData data = dataOf(bent(window), 20, true, 4);
    RigOptions options;
    options.window = window;
    options.window.normal = Vec3d(0, 0, 1);
    CHECK(chooseLens(data, options, true).scores.empty());
    options.flags = GLASS_FREE_INTRINSICS;
    const LensChoice choice = chooseLens(data, options, true);
    REQUIRE(!choice.scores.empty());
    CHECK_THAT(choice.sentence(), Catch::Contains("held-out images through the window"));
    CHECK(choice.lens().coefficients <= 4);
    CHECK(choice.lens().coefficients >= 1);
    // What it leaves out is in every +-, and tells no lens: the rig is as sealed as before.
    setLens(choice, options);
    REQUIRE(options.carriedCoefficients(0) > choice.lens().coefficients);
    std::vector<LensSource> sources;
    const RigModel start = startModel(data, options, sources);
    RigModel exact = start.clone();
    exact.known.clear();
    const Fit open = fitAllImages(data, start, sources, options.flags), closed = fitAllImages(data, exact, sources, options.flags);
    CHECK(open.stdDeviations.at<double>(INTRINSICS + 4) > 0.);
    CHECK(closed.stdDeviations.at<double>(INTRINSICS + 4) == 0.);
    CHECK(open.stdDeviations.at<double>(0) > closed.stdDeviations.at<double>(0));       // of fx
}

TEST_CASE("No fisheye is chosen where boards that are nearly parallel to the image tell no focal length", "[lens_choice]")
{
    const Ptr<RefractiveCamera> camera = bent();
    scenes::Random random(17);
    RigData data = dataOf(camera, 8, false, 17);
    for (View& view : data.views)
    {
        const Vec3d rvec = random.vector(0.02), tvec(random.uniform(-120, 120), random.uniform(-90, 90), random.uniform(400, 600));
        refractiveProjectPoints(view.objectPoints, rvec, tvec, camera, view.direct[0]);
        for (Point2d& p : view.direct[0])
            p += Point2d(random.normal(0.2), random.normal(0.2));
    }
    CHECK(chooseLens(data, RigOptions(), false).scores.empty());
}

TEST_CASE("Nothing is chosen for a lens that is known", "[lens_choice]")
{
    RigOptions options;
    options.known[0] = bent();
    CHECK(chooseLens(dataOf(bent(), 15, false, 5), options, true).scores.empty());
}

TEST_CASE("Of a lens no more coefficients are left open than are asked for", "[lens_choice]")
{
    LensChoice choice;
    choice.scores.push_back({"opencv", 0, 5, 0.1});
    choice.leftOut.push_back(Mat::zeros(INTRINSICS + RICHEST_LENS, INTRINSICS + RICHEST_LENS, CV_64F));
    choice.leftOut[0].at<double>(INTRINSICS + 5, INTRINSICS + 5) = 1;          // k4, of a rational lens
    for (const int richest : {RICHEST_LENS, POLYNOMIAL_LENS})
    {
        RigOptions options;
        setLens(choice, options, richest);
        CHECK(options.lensCoefficients == 5);
        CHECK(options.carriedCoefficients(0) == richest);
    }
}
