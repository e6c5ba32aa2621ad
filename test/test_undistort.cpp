// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refractiveUndistortPoints: where a pinhole without window and distortion would see the same points.
#include "scenes.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

//! Scene points that the camera sees, and their raw pixels.
struct Seen
{
    std::vector<Vec3d> points;
    std::vector<Vec2d> pixels;
    std::vector<double> depths;
};

Seen somePoints(const Ptr<RefractiveCamera>& camera, const LensKind& lens, double degrees, Random& random)
{
    const double near = 400, far = 2000;
    std::vector<Vec3d> points;
    for (int i = 0; i < 500; i++)
    {
        const Vec3d d = randomNormal(random, std::min(degrees, 0.9*lens.halfField));
        points.push_back(random.uniform(near, far)/d[2]*d);
    }
    std::vector<Vec2d> pixels;
    std::vector<uchar> status;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels, status);
    Seen seen;
    for (size_t i = 0; i < points.size(); i++)
        if (status[i] == REFRACT_OK)
        {
            seen.points.push_back(points[i]);
            seen.pixels.push_back(pixels[i]);
            seen.depths.push_back(points[i][2]);
        }
    REQUIRE(seen.points.size() > 200);
    return seen;
}

} // namespace

TEST_CASE("Undistorted points are the pinhole images of the scene points", "[undistort]")
{
    const WindowKind kind = GENERATE(from_range(allWindows()));
    CAPTURE(name(kind), seed());
    Random random(kind);
    double worst = 0;
    const Matx33d P(800, 0, 500, 0, 810, 400, 0, 0, 1);
    for (const LensKind& lens : allLenses())
    {
        CAPTURE(lens.name);
        const Ptr<RefractiveCamera> camera = makeCamera(lens, makeWindow(kind, random, 15));
        // Not up to the critical angle of an air gap in water, where the origin of a ray runs away to infinity.
        const Seen seen = somePoints(camera, lens, kind == DOUBLE_GLAZING_IN_WATER ? 30 : 60, random);
        const Vec3d rvec = random.vector(0.1);
        Matx33d R;
        Rodrigues(rvec, R);

        std::vector<Vec2d> plain, rectified, byVector;
        std::vector<uchar> status;
        refractiveUndistortPoints(seen.pixels, plain, camera, seen.depths, noArray(), noArray(), status);
        refractiveUndistortPoints(seen.pixels, rectified, camera, seen.depths, R, P);
        Matx34d P34 = Matx34d::zeros();
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++)
                P34(r, c) = P(r, c);
        P34(0, 3) = -12345;     // a baseline of stereoRectify's: not part of the correction
        refractiveUndistortPoints(seen.pixels, byVector, camera, seen.depths, rvec, P34);
        CHECK(largestDifference(rectified, byVector) < 1e-9);
        for (size_t i = 0; i < seen.points.size(); i++)
        {
            const Vec3d X = seen.points[i], Y = P*(R*X);
            REQUIRE(status[i] == REFRACT_OK);
            const double error = norm(plain[i] - Vec2d(X[0]/X[2], X[1]/X[2]));
            worst = std::max(worst, error);
            REQUIRE(error < 1e-11);
            if ((R*X)[2] > 0.1*norm(X))
                REQUIRE(norm(rectified[i] - Vec2d(Y[0]/Y[2], Y[1]/Y[2])) < 1e-7);
        }
    }
    printNumber(std::string("undistorted points, ") + name(kind) + ", worst", worst, "(normalised)");
}

TEST_CASE("Without window and depth only the lens is undone: converged cv::undistortPoints", "[undistort]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    if (kind.model != "opencv")
        return;
    CAPTURE(kind.name, seed());
    Random random;
    std::vector<Vec2d> pixels;
    std::vector<Vec3d> points;
    for (int i = 0; i < 300; i++)
        points.push_back(randomNormal(random, std::min(30., kind.halfField)));
    refractiveProjectPoints(points, Vec3d(), Vec3d(), makeCamera(kind, GlassWindow()), pixels);
    std::vector<Vec2d> ours, theirs;
    refractiveUndistortPoints(pixels, ours, kind.K, kind.coefficients, GlassWindow(), INF);
    undistortPoints(pixels, theirs, kind.K, kind.coefficients, noArray(), noArray(),
                    TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 1000, 1e-13));
    CHECK(largestDifference(ours, theirs) < 1e-11);
}

TEST_CASE("Infinitely far: a window with equal media does nothing, water outside bends", "[undistort]")
{
    const Matx33d K(1000, 0, 640, 0, 1000, 480, 0, 0, 1);
    const std::vector<Vec2d> pixels = { { 640, 480 }, { 100, 200 }, { 1200, 900 } };
    std::vector<Vec2d> none, pane, deep, water;
    refractiveUndistortPoints(pixels, none, K, noArray(), GlassWindow(), INF);
    const GlassWindow glass(Vec3d(0.2, -0.1, 1), 20, 1.5, 30);
    refractiveUndistortPoints(pixels, pane, K, noArray(), glass, std::vector<double>{ INF });
    refractiveUndistortPoints(pixels, deep, K, noArray(), glass, std::vector<double>{ 1e15 });
    CHECK(largestDifference(pane, none) < 1e-15);
    CHECK(largestDifference(deep, pane) < 1e-12);
    refractiveUndistortPoints(pixels, water, K, noArray(), GlassWindow(Vec3d(0, 0, 1), 20, 1.5, 30, 1.333), INF);
    CHECK(norm(water[0]) < 1e-15);
    const double r = norm(none[1]), sine = r/std::sqrt(1 + r*r)/1.333;
    CHECK(norm(water[1]) == Approx(sine/std::sqrt(1 - sine*sine)).epsilon(1e-13));
}

TEST_CASE("One depth serves all points, N depths one each", "[undistort]")
{
    const Matx33d K(1000, 0, 640, 0, 1000, 480, 0, 0, 1);
    const GlassWindow glass(Vec3d(0.2, -0.1, 1), 20, 1.5, 30);
    const std::vector<Vec2d> pixels = { { 640, 480 }, { 100, 200 }, { 1200, 900 } };
    std::vector<Vec2d> one, many, mixed;
    std::vector<uchar> status;
    refractiveUndistortPoints(pixels, one, K, noArray(), glass, std::vector<float>{ 500 });
    for (const Mat& depth : { Mat(3, 1, CV_64F, Scalar(500)), Mat(1, 3, CV_64F, Scalar(500)), Mat(3, 1, CV_32F, Scalar(500)) })
    {
        refractiveUndistortPoints(pixels, many, K, noArray(), glass, depth);
        CHECK(largestDifference(one, many) == 0);
    }
    refractiveUndistortPoints(pixels, many, K, noArray(), glass, Scalar(500));     // as a number comes from Python
    CHECK(largestDifference(one, many) == 0);
    refractiveUndistortPoints(pixels, mixed, K, noArray(), glass, std::vector<double>{ 500, NaN, INF }, noArray(),
                              noArray(), status);
    CHECK(mixed[0] == one[0]);
    CHECK(status[1] == REFRACT_NOT_FINITE);
    CHECK(std::isnan(mixed[1][0]));
    CHECK(status[2] == REFRACT_OK);
    CHECK(norm(mixed[2] - Vec2d(0.56, 0.42)) < 1e-15);
}

TEST_CASE("A number as Python hands it over is no guess for four points; without window depth may be left out", "[undistort]")
{
    const Matx33d K(1000, 0, 640, 0, 1000, 480, 0, 0, 1);
    const GlassWindow glass(Vec3d(0.2, -0.1, 1), 20, 1.5, 30);
    const std::vector<Vec2d> pixels = { { 640, 480 }, { 100, 200 }, { 1200, 900 }, { 30, 10 } };
    std::vector<Vec2d> out, same;
    CHECK_THAT(thrown([&] { refractiveUndistortPoints(pixels, out, K, noArray(), glass, Scalar(600)); }),
               Contains("depth is (600, 0, 0, 0) for four points"));
    refractiveUndistortPoints(pixels, out, K, noArray(), glass, 600.);
    refractiveUndistortPoints(pixels, same, K, noArray(), glass, Scalar::all(600));
    CHECK(largestDifference(out, same) == 0);

    refractiveUndistortPoints(pixels, out, K, noArray(), GlassWindow(), noArray());
    refractiveUndistortPoints(pixels, same, K, noArray(), GlassWindow(), 600.);
    CHECK(largestDifference(out, same) < 1e-15);
}

TEST_CASE("A depth that is a number is one, for four points too", "[undistort]")
{
    const Ptr<RefractiveCamera> bare = RefractiveCamera::create(PLAIN_K, noArray());
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, noArray(), paper::pane());
    const std::vector<Vec2d> pixels = { { 640, 480 }, { 100, 200 }, { 1200, 900 }, { 30, 10 } };
    const std::vector<double> each(4, 600.);
    Mat number, many, map1, map2, none;
    refractiveUndistortPoints(pixels, many, camera, each);
    refractiveUndistortPoints(pixels, number, camera, 600.);
    CHECK(largestDifference(number, many) == 0);
    refractiveUndistortPoints(pixels, number, PLAIN_K, noArray(), paper::pane(), 600);       // an int is a number, too
    CHECK(largestDifference(number, many) == 0);
    initRefractiveUndistortRectifyMap(camera, 600., noArray(), noArray(), Size(64, 48), CV_32FC2, map1, none);
    initRefractiveUndistortRectifyMap(PLAIN_K, noArray(), paper::pane(), std::vector<double>(1, 600.), noArray(), noArray(),
                                      Size(64, 48), CV_32FC2, map2, none);
    CHECK(norm(map1, map2, NORM_INF) == 0);

    std::vector<Vec2d> out;
    for (double bad : { 0., -1., NaN })
        CHECK_THAT(thrown([&] { refractiveUndistortPoints(pixels, out, camera, bad); }), Contains("depth is"));
    CHECK_THAT(thrown([&] { refractiveUndistortPoints(pixels, out, bare, -1.); }), Contains("depth is -1"));
    // Python's None is 0 where a double is wanted: not said, which a camera without window does not mind.
    std::vector<Vec2d> same;
    refractiveUndistortPoints(pixels, out, bare, 0.);
    refractiveUndistortPoints(pixels, same, bare, noArray());
    CHECK(largestDifference(out, same) == 0);
}

TEST_CASE("Distorted points are the raw pixels that undistorted ones come from", "[undistort]")
{
    const WindowKind kind = GENERATE(from_range(allWindows()));
    CAPTURE(name(kind), seed());
    Random random(kind);
    const Matx33d P(800, 0, 500, 0, 810, 400, 0, 0, 1);
    double worst = 0;
    for (const LensKind& lens : allLenses())
    {
        CAPTURE(lens.name);
        const Ptr<RefractiveCamera> camera = makeCamera(lens, makeWindow(kind, random, 15));
        const Seen seen = somePoints(camera, lens, kind == DOUBLE_GLAZING_IN_WATER ? 30 : 60, random);
        const Vec3d rvec = random.vector(0.1);
        std::vector<Vec2d> corrected, pixels, plain;
        std::vector<uchar> there, back;
        refractiveUndistortPoints(seen.pixels, corrected, camera, seen.depths, rvec, P, there);
        refractiveDistortPoints(corrected, pixels, camera, seen.depths, rvec, P, back);
        for (size_t i = 0; i < pixels.size(); i++)
        {
            if (there[i] != REFRACT_OK)     // turned away behind the rectified camera
                continue;
            REQUIRE(back[i] == REFRACT_OK);
            const double error = norm(pixels[i] - seen.pixels[i]);
            worst = std::max(worst, error/(1 + 1e-3*norm(corrected[i])));
        }
    }
    printNumber(std::string("distorted points, ") + name(kind) + ", worst", worst, "px");
    CHECK(worst < 1e-6);
}

TEST_CASE("Distorted points without answer have a status; without window they are cv::projectPoints", "[undistort]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, noArray(), GlassWindow(Vec3d(0, 0, 1), 20, 1.5, 30));
    const std::vector<Vec2d> points = { { 0.1, 0.2 }, { NaN, 0 }, { 0.1, 0.1 }, { 0.1, 0.1 }, { 0.1, 0.1 } };
    std::vector<Vec2d> out, each;
    std::vector<uchar> status;
    refractiveDistortPoints(points, out, camera, std::vector<double>{ 600, 600, 40, -100, NaN }, noArray(), noArray(), status);
    CHECK(status[0] == REFRACT_OK);
    CHECK(status[1] == REFRACT_NOT_FINITE);
    CHECK(status[2] == REFRACT_BEHIND_WINDOW);
    CHECK(status[3] == REFRACT_BEHIND_WINDOW);
    CHECK(status[4] == REFRACT_NOT_FINITE);
    for (int i = 1; i < 5; i++)
        CHECK((std::isnan(out[i][0]) && std::isnan(out[i][1])));
    refractiveDistortPoints(std::vector<Vec2d>(4, points[0]), each, PLAIN_K, noArray(), GlassWindow(Vec3d(0, 0, 1), 20, 1.5, 30), 600.);
    CHECK(norm(each[3] - out[0]) == 0);

    const std::vector<double> D = { -0.3, 0.1, 1e-3, -2e-3, 0.02 };
    const std::vector<Vec2d> ideal = { { 0.1, 0.2 }, { -0.3, 0.15 } };
    const std::vector<Vec3d> X = { { 0.1, 0.2, 1 }, { -0.3, 0.15, 1 } };
    std::vector<Vec2d> theirs;
    projectPoints(X, Vec3d(), Vec3d(), PLAIN_K, D, theirs);
    refractiveDistortPoints(ideal, out, PLAIN_K, D, GlassWindow(), INF);
    CHECK(largestDifference(out, theirs) < 1e-9);
    CHECK_THAT(thrown([&] { refractiveDistortPoints(ideal, out, camera, std::vector<double>(3, 1.)); }), Contains("depth has 3 values"));
    CHECK_THAT(thrown([&] { refractiveDistortPoints(ideal, out, camera, 600., noArray(), Matx33d::zeros()); }), Contains("P is singular"));
    CHECK_THAT(thrown([&] { refractiveDistortPoints(Mat(5, 1, CV_8UC2), out, camera, 600.); }), Contains("undistorted is"));
}

TEST_CASE("Depths with no point have a status", "[undistort]")
{
    const Matx33d K(1000, 0, 640, 0, 1000, 480, 0, 0, 1);
    const GlassWindow glass(Vec3d(0, 0, 1), 20, 1.5, 30);
    const std::vector<Vec2d> pixels(5, Vec2d(700, 500));
    std::vector<Vec2d> out;
    std::vector<uchar> status;
    refractiveUndistortPoints(pixels, out, K, noArray(), glass, std::vector<double>{ 51, 49, 20, -100, 500 }, noArray(),
                              noArray(), status);
    CHECK(status[0] == REFRACT_OK);
    CHECK(status[1] == REFRACT_BEHIND_WINDOW);
    CHECK(status[2] == REFRACT_BEHIND_WINDOW);
    CHECK(status[3] == REFRACT_BEHIND_WINDOW);
    CHECK(status[4] == REFRACT_OK);
    for (int i = 1; i < 4; i++)
        CHECK((std::isnan(out[i][0]) && std::isnan(out[i][1])));

    const Vec3d halfTurn(0, CV_PI, 0);
    refractiveUndistortPoints(pixels, out, K, noArray(), glass, std::vector<double>{ 500 }, halfTurn, noArray(), status);
    CHECK(status[0] == REFRACT_BEHIND_CAMERA);
    CHECK(std::isnan(out[0][0]));
}

TEST_CASE("Depths that are not positive have the same status both ways, behind any window", "[undistort]")
{
    Random random;
    const LensKind wide = lensNamed("fisheye");     // it also sees what lies behind it
    const std::vector<double> depths = { -5, 0, -0., -1e-300, -1e6, -INF, NaN, 1e3 };
    const int count = (int)depths.size();
    for (WindowKind kind : allWindows())
        for (const LensKind& lens : { lensNamed("the paper's"), wide })
            for (const Vec2d& at : { Vec2d(0.1, 0.05), Vec2d(-0.3, 0.2), Vec2d() })
                for (const Vec3d& rvec : { Vec3d(), Vec3d(0.1, 0.2, 0), Vec3d(0, CV_PI, 0) })
                {
                    const Ptr<RefractiveCamera> camera = makeCamera(lens, makeWindow(kind, random, 15));
                    const Mat K = camera->cameraMatrix();
                    const Vec2d pixel(K.at<double>(0, 2) + K.at<double>(0, 0)*at[0], K.at<double>(1, 2) + K.at<double>(1, 1)*at[1]);
                    std::vector<Vec2d> out;
                    std::vector<uchar> there, back;
                    refractiveUndistortPoints(std::vector<Vec2d>(count, pixel), out, camera, depths, rvec, noArray(), there);
                    refractiveDistortPoints(std::vector<Vec2d>(count, at), out, camera, depths, rvec, noArray(), back);
                    for (int i = 0; i < count; i++)
                    {
                        CAPTURE(name(kind), lens.name, at, rvec, depths[i], (int)there[i], (int)back[i], seed());
                        const int expected = std::isnan(depths[i]) ? REFRACT_NOT_FINITE
                                             : kind == NO_WINDOW ? REFRACT_NO_INTERSECTION : REFRACT_BEHIND_WINDOW;
                        if (depths[i] > 0)
                            continue;
                        CHECK(there[i] == expected);
                        CHECK(back[i] == expected);
                        CHECK((std::isnan(out[i][0]) && std::isnan(out[i][1])));
                    }
                    if (rvec[1] < 1)
                        CHECK((there.back() == REFRACT_OK && back.back() == REFRACT_OK));
                }
}

TEST_CASE("Bad arguments of refractiveUndistortPoints are named", "[undistort]")
{
    const Matx33d K(1000, 0, 640, 0, 1000, 480, 0, 0, 1);
    const GlassWindow glass(Vec3d(0, 0, 1), 20, 1.5, 30);
    const std::vector<Vec2d> pixels(3, Vec2d(700, 500));
    const auto undistort = [&](InputArray depth, InputArray R, InputArray P)
    {
        std::vector<Vec2d> out;
        return thrown([&] { refractiveUndistortPoints(pixels, out, K, noArray(), glass, depth, R, P); });
    };
    CHECK(undistort(500., noArray(), noArray()) == "");
    CHECK_THAT(undistort(noArray(), noArray(), noArray()), Contains("depth is empty"));
    CHECK_THAT(undistort(std::vector<double>(2, 500.), noArray(), noArray()), Contains("depth") && Contains("2"));
    CHECK_THAT(undistort(std::vector<double>(1, -5.), noArray(), noArray()), Contains("depth") && Contains("-5"));
    CHECK_THAT(undistort(std::vector<double>(1, NaN), noArray(), noArray()), Contains("depth") && Contains("nan"));
    CHECK(undistort(Mat(3, 1, CV_32S, Scalar(500)), noArray(), noArray()) == "");
    CHECK_THAT(undistort(500., Matx22d::eye(), noArray()), Contains("R is 2x2"));
    CHECK_THAT(undistort(500., Matx33d::eye()*3, noArray()), Contains("R is not a rotation"));
    CHECK_THAT(undistort(500., noArray(), Matx22d::eye()), Contains("P is 2x2"));
    CHECK_THAT(undistort(500., noArray(), Matx33d::zeros()), Contains("P is singular"));
    CHECK_THAT(undistort(500., noArray(), Matx33d(1, 0, INF, 0, 1, 0, 0, 0, 1)), Contains("P[2]") && Contains("inf"));
}
