// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibration_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

static Mat normalOf(const CalibrationScene& scene, const Ptr<RefractiveCamera>& camera)
{
    Mat normal;
    calibrateGlassNormal(scene.direct, scene.refracted, camera, normal);
    return normal;
}

TEST_CASE("The normal from perfect pairs is exact, whatever the window", "[calibrate_normal]")
{
    for (WindowKind kind : { PANE_IN_AIR, LAMINATE, AIR_GLASS_WATER, BARE_WATER, GLASS_ON_LENS })
    {
        Random random(100 + kind);
        CAPTURE(name(kind), seed());
        const Ptr<RefractiveCamera> camera = paperCamera(makeWindow(kind, random));
        const CalibrationScene scene = makeScene(camera, 2, random, 0);
        Mat normal, centre, covariance;
        const double rms = calibrateGlassNormal(scene.direct, scene.refracted, camera, normal, centre, covariance);
        CHECK(rms < 1e-8);
        CHECK(angleBetween(normal, camera->window().normal) < 1e-6);
        const Matx33d K = camera->cameraMatrix();
        const Vec3d n = camera->window().normal;
        CHECK(std::abs(centre.at<double>(0) - (K(0, 2) + K(0, 0)*n[0]/n[2])) < 1e-4);
        CHECK(std::abs(centre.at<double>(1) - (K(1, 2) + K(1, 1)*n[1]/n[2])) < 1e-4);
        CHECK(covariance.size() == Size(3, 3));
    }
}

TEST_CASE("The distortion centre may lie far outside the image", "[calibrate_normal]")
{
    Random random(110);
    GlassWindow window = paper::pane();
    window.normal = normalize(Vec3d(1, 0.2, 0.02));     // 89 degrees: no such window could be looked through at length
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createFisheye(lensNamed("fisheye").K, lensNamed("fisheye").coefficients,
                                                                         window);
    std::vector<Point2d> direct, refracted;
    std::vector<Point3d> points;
    for (int i = 0; i < 40; i++)
        points.push_back({ random.uniform(300, 600), random.uniform(-200, 200), random.uniform(200, 500) });
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, refracted);
    refractiveProjectPoints(points, Vec3d(), Vec3d(), RefractiveCamera::createFisheye(
                            lensNamed("fisheye").K, lensNamed("fisheye").coefficients), direct);
    Mat normal;
    calibrateGlassNormal(std::vector<std::vector<Point2d> >(1, direct), std::vector<std::vector<Point2d> >(1, refracted),
                         camera, normal);
    CHECK(angleBetween(normal, window.normal) < 1e-6);
}

TEST_CASE("A pair with a point next to the distortion centre has an answer", "[calibrate_normal]")
{
    GlassWindow window = paper::pane();
    window.normal = normalize(Vec3d(0.05, -0.03, 1));
    const Ptr<RefractiveCamera> camera = paperCamera(window);
    for (int run = 0; run < 6000; run++)      // one in some thousands converges slowly
    {
        Random random(3000 + run);
        CAPTURE(run, seed());
        const CalibrationScene scene = makeScene(camera, 1, random, 0.166);
        REQUIRE(angleBetween(normalOf(scene, camera), window.normal) < 2);     // degrees
    }
}

TEST_CASE("The RMS of the lines is the pixel noise, the covariance is the sampled one", "[calibrate_normal]")
{
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    const Vec3d truth = camera->window().normal;
    const double sigma = 0.1;
    const int runs = 300;
    double squares = 0, mahalanobis = 0;
    for (int run = 0; run < runs; run++)
    {
        Random random(1000 + run);
        const CalibrationScene scene = makeScene(camera, 3, random, sigma);
        Mat normal, covariance;
        const double rms = calibrateGlassNormal(scene.direct, scene.refracted, camera, normal, noArray(), covariance);
        squares += rms*rms/runs;
        Mat inverse;
        invert(covariance, inverse, DECOMP_SVD);
        const Mat error = normal - Mat(truth);
        mahalanobis += Mat(error.t()*inverse*error).at<double>(0)/runs;
    }
    CAPTURE(squares, mahalanobis, seed());
    CHECK(std::sqrt(squares) == Approx(sigma).epsilon(0.03));
    CHECK(mahalanobis == Approx(2).epsilon(0.2));       // chi^2 with two degrees of freedom
}

TEST_CASE("The covariance holds where points near the centre move less than their noise", "[calibrate_normal]")
{
    struct { double thickness, tilt, sigma; } rigs[] = { { 5, 0, 0.1 }, { 20, 0, 0.3 }, { 20, 0.35, 0.3 }, { 12, 0.15, 0.1 } };
    for (const auto& rig : rigs)
    {
        double mahalanobis = 0;
        int count = 0;
        const int runs = trials(300);
        for (int run = 0; run < runs; run++)
        {
            Random random(5000 + run);
            const double azimuth = random.uniform(0, 2*CV_PI);
            const Vec3d truth(std::sin(rig.tilt)*std::cos(azimuth), std::sin(rig.tilt)*std::sin(azimuth), std::cos(rig.tilt));
            const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(1200, 0, 640, 0, 1200, 480, 0, 0, 1), noArray(),
                                                                          GlassWindow(truth, rig.thickness, 1.52, 20));
            ObjectViews views;
            for (int i = 0; i < 4; i++)
                views.push_back(board(8, 6, 35));
            const CalibrationScene scene = makeScene(camera, views, random, rig.sigma);
            Mat normal, covariance, inverse;
            try { calibrateGlassNormal(scene.direct, scene.refracted, camera, normal, noArray(), covariance); }
            catch (const CalibrationError&) { continue; }
            invert(covariance, inverse, DECOMP_SVD);
            const Mat error = normal - Mat(truth);
            mahalanobis += Mat(error.t()*inverse*error).at<double>(0);
            count++;
        }
        CAPTURE(rig.thickness, rig.tilt, rig.sigma, count, seed());
        printNumber("squares of the normal's error over stated, two degrees of freedom", mahalanobis/count, "");
        CHECK(count >= 0.98*runs);
        CHECK(mahalanobis/count == Approx(2).epsilon(0.25));
    }
}

TEST_CASE("Points on one line through the centre do not determine the normal, whatever their noise says", "[calibrate_normal]")
{
    int refused = 0;
    const int runs = trials(200);
    for (int run = 0; run < runs; run++)
    {
        Random random(7000 + run);
        const double azimuth = random.uniform(0, 2*CV_PI), line = random.uniform(0, 2*CV_PI);
        const Vec3d n(std::sin(0.35)*std::cos(azimuth), std::sin(0.35)*std::sin(azimuth), std::cos(0.35));
        const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(1000, 0, 640, 0, 1000, 480, 0, 0, 1), noArray(),
                                                                      GlassWindow(n, 20, 1.52, 30));
        Vec3d along(std::cos(line), std::sin(line), 0);
        along = normalize(along - along.dot(n)*n);
        std::vector<Point3d> points;
        for (int i = 1; i <= 20; i++)
            points.push_back(Point3d(700*n + 15.*i*along));
        std::vector<Point2d> direct, refracted;
        refractiveProjectPoints(points, Vec3d(), Vec3d(), RefractiveCamera::create(camera->cameraMatrix(), noArray()), direct);
        refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, refracted);
        for (int i = 0; i < 20; i++)
            for (std::vector<Point2d>* pixels : { &direct, &refracted })
                (*pixels)[i] += Point2d(random.normal(0.05), random.normal(0.05));
        Mat normal;
        refused += !thrown([&] { calibrateGlassNormal(PixelViews(1, direct), PixelViews(1, refracted), camera, normal); }).empty();
    }
    CAPTURE(refused, runs, seed());
    CHECK(refused >= 0.95*runs);
}

TEST_CASE("Pairs with NaN are left out, overloads and types agree", "[calibrate_normal]")
{
    Random random(120);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    CalibrationScene scene = makeScene(camera, 2, random, 0.1);
    const Mat whole = normalOf(scene, camera);

    Mat byMatrices;
    calibrateGlassNormal(scene.direct, scene.refracted, camera->cameraMatrix(), camera->distCoeffs(), byMatrices);
    CHECK(largestDifference(whole, byMatrices) == 0);

    std::vector<Mat> direct, refracted;
    for (size_t i = 0; i < scene.direct.size(); i++)
    {
        direct.push_back(Mat(scene.direct[i]).reshape(1));
        Mat(scene.refracted[i]).convertTo(byMatrices, CV_32F);
        refracted.push_back(byMatrices.clone());
    }
    Vec3d asVector;
    calibrateGlassNormal(direct, refracted, camera, asVector);
    CHECK(angleBetween(asVector, whole) < 1e-3);

    CalibrationScene less = scene;
    less.direct[0].erase(less.direct[0].begin() + 3);
    less.refracted[0].erase(less.refracted[0].begin() + 3);
    scene.direct[0][3].x = NaN;
    CHECK(largestDifference(normalOf(less, camera), normalOf(scene, camera)) < 1e-14);
}

TEST_CASE("Pairs that do not determine the normal are refused", "[calibrate_normal]")
{
    Random random(130);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    const CalibrationScene scene = makeScene(camera, 2, random, 0.1);
    const auto why = [&](const PixelViews& direct, const PixelViews& refracted)
    { return thrown([&] { Mat normal; calibrateGlassNormal(direct, refracted, camera, normal); }); };

    CHECK_THAT(why(scene.direct, scene.direct), Catch::Contains("no point moves"));
    CHECK_THAT(why({}, {}), Catch::Contains("at least 2"));
    CHECK_THAT(why({ { scene.direct[0][0] } }, { { scene.refracted[0][0] } }), Catch::Contains("at least 2"));
    CHECK_THAT(why({ { { NaN, 1 }, { 2, 3 } } }, { { { 4, 5 }, { 6, 7 } } }), Catch::Contains("at least 2"));
    CHECK_THAT(why(scene.direct, { scene.refracted[0] }), Catch::Contains("imagePointsDirect has 2 views"));
    PixelViews shorter = scene.refracted;
    shorter[1].pop_back();
    CHECK_THAT(why(scene.direct, shorter), Catch::Contains("imagePointsRefracted[1] 29"));
    CHECK_THAT(thrown([&] { Mat normal; calibrateGlassNormal(scene.direct[0], scene.refracted[0], camera, normal); }),
               Catch::Contains("imagePointsDirect is one array"));

    // the same point twice: one line
    CHECK_THAT(why({ { scene.direct[0][0], scene.direct[0][0] } }, { { scene.refracted[0][0], scene.refracted[0][0] } }),
               Catch::Contains("one and the same line"));

    // no window between the two images, only noise
    PixelViews noisy = scene.direct;
    for (std::vector<Point2d>& view : noisy)
        for (Point2d& p : view)
            p += Point2d(random.normal(0.1), random.normal(0.1));
    CHECK_THAT(why(scene.direct, noisy), Catch::Contains("undetermined"));
}
