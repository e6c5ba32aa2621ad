// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibration_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

static Ptr<RefractiveCamera> bareCamera(const Ptr<RefractiveCamera>& camera)
{
    return RefractiveCamera::create(camera->cameraMatrix(), camera->distCoeffs());
}

//! The same lens behind another window.
static Ptr<RefractiveCamera> startCamera(const Ptr<RefractiveCamera>& camera, const GlassWindow& window)
{
    return RefractiveCamera::create(camera->cameraMatrix(), camera->distCoeffs(), window);
}

//! The window looking straight ahead: what a user who knows nothing starts from.
static GlassWindow straight(GlassWindow window)
{
    window.normal = Vec3d(0, 0, 1);
    return window;
}

static double calibrate(const CalibrationScene& scene, bool paired, const Ptr<RefractiveCamera>& camera, int flags = 0)
{
    return calibrateGlass(scene.object, paired ? scene.direct : PixelViews(), scene.refracted, camera, noArray(),
                          noArray(), flags);
}

static std::string whyNot(const CalibrationScene& scene, bool paired, const Ptr<RefractiveCamera>& camera, int flags)
{
    return thrown([&] { calibrate(scene, paired, camera, flags); });
}

TEST_CASE("Perfect data give the window back, with pairs and without, for every kind", "[calibrate_glass]")
{
    for (WindowKind kind : { PANE_IN_AIR, LAMINATE, AIR_GLASS_WATER, BARE_WATER, GLASS_ON_LENS, WATER_GLASS_AIR,
                             DOUBLE_GLAZING_IN_WATER, WEDGE_IN_AIR, WEDGE_IN_WATER })
        for (bool paired : { true, false })
        {
            Random random(300 + kind);
            CAPTURE(name(kind), paired, seed());
            const Ptr<RefractiveCamera> camera = paperCamera(makeWindow(kind, random));
            const CalibrationScene scene = makeScene(camera, 6, random, 0);
            const Ptr<RefractiveCamera> found = startCamera(camera, straight(camera->window()));
            CHECK(calibrate(scene, paired, found) < 1e-6);
            CHECK(angleBetween(found->window().normal, camera->window().normal) < 1e-4);
            CHECK(found->window().distance == camera->window().distance);
            CHECK(found->window().thickness == camera->window().thickness);
            CHECK(found->window().index == camera->window().index);
            CHECK(found->window().wedge == camera->window().wedge);
        }
}

TEST_CASE("What is free is found", "[calibrate_glass]")
{
    Random random(310);
    CAPTURE(seed());

    SECTION("thickness and index of a pane, pairs")
    {
        const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
        const CalibrationScene scene = makeScene(camera, 6, random, 0);
        const Ptr<RefractiveCamera> found = startCamera(camera, GlassWindow({ 0, 0, 1 }, 15, 1.45, 50));
        CHECK(calibrate(scene, true, found, GLASS_FREE_THICKNESS | GLASS_FREE_INDEX) < 1e-6);
        CHECK(found->window().thickness[0] == Approx(20).epsilon(1e-4));
        CHECK(found->window().index[0] == Approx(1.5437).epsilon(1e-4));
    }
    SECTION("distance behind glass and water, glass-only")
    {
        const Ptr<RefractiveCamera> camera = paperCamera(GlassWindow({ -0.2, 0.1, 1 }, 8, 1.49, 80, 1.333));
        const CalibrationScene scene = makeScene(camera, 6, random, 0);
        const Ptr<RefractiveCamera> found = startCamera(camera, GlassWindow({ 0, 0, 1 }, 8, 1.49, 20, 1.333));
        CHECK(calibrate(scene, false, found, GLASS_FREE_DISTANCE) < 1e-6);
        CHECK(found->window().distance == Approx(80).epsilon(1e-5));
        CHECK(angleBetween(found->window().normal, camera->window().normal) < 1e-4);
    }
    SECTION("distance of a bare water surface, started on the lens")
    {
        GlassWindow window = straight(GlassWindow());
        window.normal = normalize(Vec3d(0.1, -0.2, 1));
        window.distance = 60;
        window.outerIndex = 1.333;
        const Ptr<RefractiveCamera> camera = paperCamera(window);
        const CalibrationScene scene = makeScene(camera, 6, random, 0);
        window.distance = 0;
        const Ptr<RefractiveCamera> found = startCamera(camera, straight(window));
        CHECK(calibrate(scene, false, found, GLASS_FREE_DISTANCE) < 1e-6);
        CHECK(found->window().distance == Approx(60).epsilon(1e-5));
    }
    SECTION("distance and index of the water, pairs")
    {
        const Ptr<RefractiveCamera> camera = paperCamera(GlassWindow({ -0.2, 0.1, 1 }, 8, 1.49, 80, 1.333));
        const CalibrationScene scene = makeScene(camera, 6, random, 0);
        const Ptr<RefractiveCamera> found = startCamera(camera, GlassWindow({ 0, 0, 1 }, 8, 1.49, 60, 1.2));
        CHECK(calibrate(scene, true, found, GLASS_FREE_DISTANCE | GLASS_FREE_OUTER_INDEX) < 1e-6);
        CHECK(found->window().distance == Approx(80).epsilon(1e-5));
        CHECK(found->window().outerIndex == Approx(1.333).epsilon(1e-6));
    }
    SECTION("the lens, pairs; all coefficients, though they start at 0")
    {
        const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
        const CalibrationScene scene = makeScene(camera, 12, random, 0);
        const Ptr<RefractiveCamera> found = RefractiveCamera::create(
            Matx33d(2400, 0, 640, 0, 2400, 512, 0, 0, 1), std::vector<double>(4, 0.), straight(paper::pane()));
        CHECK(calibrate(scene, true, found, GLASS_FREE_INTRINSICS) < 1e-5);
        CHECK(largestDifference(found->lensParameters(), camera->lensParameters()) < 1e-2);
        CHECK(angleBetween(found->window().normal, camera->window().normal) < 1e-3);
    }
    SECTION("the lens, pairs; what the flags fix stays")
    {
        const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
        const CalibrationScene scene = makeScene(camera, 12, random, 0);
        const Ptr<RefractiveCamera> found = RefractiveCamera::create(
            Matx33d(2400, 0, 640, 0, 2400, 512, 0, 0, 1), std::vector<double>{ -0.3, 0.1, 0, 0 }, straight(paper::pane()));
        CHECK(calibrate(scene, true, found, GLASS_FREE_INTRINSICS | GLASS_FIX_TANGENT_DIST) < 1e-5);
        CHECK(largestDifference(found->lensParameters(), camera->lensParameters()) < 1e-2);
        CHECK(found->distCoeffs().at<double>(2) == 0);
        CHECK(found->distCoeffs().at<double>(3) == 0);
        CHECK(angleBetween(found->window().normal, camera->window().normal) < 1e-3);
    }
}

TEST_CASE("Each flag fixes what it names, and nothing else", "[calibrate_glass]")
{
    Random random(315);
    struct Fix { int flag; std::vector<int> columns; };
    const std::vector<Fix> opencv = { { GLASS_FIX_FOCAL_LENGTH, { 0, 1 } }, { GLASS_FIX_PRINCIPAL_POINT, { 2, 3 } },
                                      { GLASS_FIX_K1, { 4 } }, { GLASS_FIX_K2, { 5 } }, { GLASS_FIX_TANGENT_DIST, { 6, 7 } },
                                      { GLASS_FIX_K3, { 8 } }, { GLASS_FIX_K4, { 9 } }, { GLASS_FIX_K5, { 10 } },
                                      { GLASS_FIX_K6, { 11 } }, { GLASS_FIX_S1_S2_S3_S4, { 12, 13, 14, 15 } },
                                      { GLASS_FIX_TAUX_TAUY, { 16, 17 } } };
    const std::vector<Fix> fisheye = { { GLASS_FIX_FOCAL_LENGTH, { 0, 1 } }, { GLASS_FIX_PRINCIPAL_POINT, { 2, 3 } },
                                       { GLASS_FIX_K1, { 4 } }, { GLASS_FIX_K2, { 5 } }, { GLASS_FIX_K3, { 6 } },
                                       { GLASS_FIX_K4, { 7 } } };
    int all = 0;
    for (const Fix& fix : opencv)
        all |= fix.flag;
    // All at once the boards do not determine: everything is fixed but what one flag names.
    const auto check = [&](const Ptr<RefractiveCamera>& camera, const Fix& fix)
    {
        CAPTURE(camera->lensModel(), fix.flag);
        const CalibrationScene scene = makeScene(camera, 8, random, 0.1);
        const Mat before = camera->lensParameters();
        calibrate(scene, true, camera, GLASS_FREE_INTRINSICS | (all & ~fix.flag));
        const Mat after = camera->lensParameters();
        for (int i = 0; i < after.rows; i++)
        {
            CAPTURE(i);
            const bool isFree = std::find(fix.columns.begin(), fix.columns.end(), i) != fix.columns.end();
            CHECK((after.at<double>(i) != before.at<double>(i)) == isFree);
        }
    };
    const Mat K = paperCamera(GlassWindow())->cameraMatrix();
    for (const Fix& fix : opencv)
        check(RefractiveCamera::create(K, std::vector<double>(14, 0.), paper::pane()), fix);
    for (const Fix& fix : fisheye)
        check(RefractiveCamera::createFisheye(K, std::vector<double>(4, 0.), paper::pane()), fix);
    check(RefractiveCamera::create(K, noArray(), paper::pane()), { GLASS_FIX_K1, {} });     // a lens that has no k1
}

TEST_CASE("Any target, each view its own, points missing, views half missing", "[calibrate_glass]")
{
    Random random(320);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    CalibrationScene scene = makeScene(camera, { board(), cloud(random), cloud(random, 12), board(9, 4, 20), board() },
                                       random, 0.05);
    scene.direct[1].clear();            // glass only
    scene.refracted[3].clear();         // direct only
    for (int i = 0; i < 8; i++)
    {
        scene.refracted[0][3*i] = Point2d(NaN, NaN);
        scene.direct[0][2*i].y = NaN;
    }
    const Ptr<RefractiveCamera> found = startCamera(camera, straight(camera->window()));
    std::vector<Mat> rvecs, tvecs;
    Mat deviations, covariance, errors, jacobian;
    const double rms = calibrateGlass(scene.object, scene.direct, scene.refracted, found, rvecs, tvecs, deviations,
                                      covariance, errors, jacobian);
    CHECK(rms == Approx(0.05*std::sqrt(2.)).epsilon(0.15));
    CHECK(angleBetween(found->window().normal, camera->window().normal) < 0.1);
    for (int i = 0; i < 5; i++)
    {
        CHECK(norm(tvecs[i], Mat(scene.tvecs[i])) < 1);
        CHECK(norm(rvecs[i], Mat(scene.rvecs[i])) < 0.01);
    }
    REQUIRE(errors.size() == Size(2, 5));
    CHECK(std::isnan(errors.at<double>(1, 0)));
    CHECK(std::isnan(errors.at<double>(3, 1)));
    CHECK(errors.at<double>(0, 0) > 0);

    const int P = 16, points = 22 + 22 + 30 + 12 + 12 + 36 + 30 + 30;
    CHECK(deviations.size() == Size(1, P));
    CHECK(covariance.size() == Size(P, P));
    CHECK(jacobian.size() == Size(P + 6*5, 2*points));
    for (int fixed : { 0, 7, 11, 12, 13, 14, 15 })
    {
        CHECK(deviations.at<double>(fixed) == 0);
        CHECK(norm(jacobian.col(fixed)) == 0);
    }

    std::vector<Vec3d> rvecs2, tvecs2;
    GlassWindow window = straight(camera->window());
    const double rms2 = calibrateGlass(scene.object, scene.direct, scene.refracted, camera->cameraMatrix(),
                                       camera->distCoeffs(), window, rvecs2, tvecs2);
    CHECK(rms2 == rms);
    CHECK(window.normal == found->window().normal);
    CHECK(norm(tvecs[2], Mat(tvecs2[2])) == 0);
}

TEST_CASE("Jacobian and covariance are those of refractiveProjectPoints and of the normal equations", "[calibrate_glass]")
{
    Random random(330);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    const CalibrationScene scene = makeScene(camera, 3, random, 0.1);
    const Ptr<RefractiveCamera> found = startCamera(camera, straight(camera->window()));
    std::vector<Vec3d> rvecs, tvecs;
    Mat deviations, covariance, errors, jacobian;
    const double rms = calibrateGlass(scene.object, scene.direct, scene.refracted, found, rvecs, tvecs, deviations,
                                      covariance, errors, jacobian, GLASS_FREE_THICKNESS | GLASS_FREE_INTRINSICS);
    const int P = 16, views = 3, n = 30;
    REQUIRE(jacobian.size() == Size(P + 6*views, 4*n*views));

    Mat byProjection;
    refractiveProjectPoints(scene.object[1], rvecs[1], tvecs[1], found, noArray(), noArray(), byProjection);
    const Mat rows = jacobian.rowRange(6*n, 8*n);       // view 1 through the window
    CHECK(largestDifference(rows.colRange(P + 6, P + 12), byProjection.colRange(0, 6)) < 1e-8);
    for (int column : { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12 })
        CHECK(largestDifference(rows.col(column), byProjection.col(6 + column)) < 1e-8);

    // rms^2 of all points from those of the views
    Mat squares = errors.mul(errors);
    CHECK(std::sqrt(mean(squares)[0]) == Approx(rms).epsilon(1e-12));

    // The pseudo-inverse of the whole information; the normal has no length and fixed columns are 0.
    Mat inverse;
    invert(jacobian.t()*jacobian, inverse, DECOMP_SVD);
    const double variance = rms*rms*2*n*views/(4*n*views - (8 + 2 + 1) - 6*views);
    const Mat expected = variance*inverse(Rect(0, 0, P, P));
    for (int i : { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 12 })
    {
        CAPTURE(i);
        CHECK(covariance.at<double>(i, i) == Approx(expected.at<double>(i, i)).epsilon(1e-3));
        CHECK(deviations.at<double>(i) == Approx(std::sqrt(covariance.at<double>(i, i))));
    }
}

TEST_CASE("The predicted uncertainty is the sampled one", "[calibrate_glass]")
{
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    const int runs = 200;
    double mahalanobis = 0, rms = 0;
    for (int run = 0; run < runs; run++)
    {
        Random random(3400 + run);
        const CalibrationScene scene = makeScene(camera, 2, random, 0.1);
        const Ptr<RefractiveCamera> found = paperCamera(paper::pane());
        Mat covariance, inverse;
        const double error = calibrateGlass(scene.object, scene.direct, scene.refracted, found, noArray(), noArray(),
                                            noArray(), covariance, noArray(), noArray(), GLASS_FREE_THICKNESS);
        rms += error*error/runs;
        Mat difference(5, 1, CV_64F);
        const Vec3d normal = found->window().normal - camera->window().normal;
        const double values[] = { normal[0], normal[1], normal[2], 0, found->window().thickness[0] - 20 };
        std::copy(values, values + 5, difference.ptr<double>());
        invert(covariance(Rect(8, 8, 5, 5)), inverse, DECOMP_SVD);
        mahalanobis += Mat(difference.t()*inverse*difference).at<double>(0)/runs;
    }
    CAPTURE(mahalanobis, rms, seed());
    CHECK(mahalanobis == Approx(3).epsilon(0.2));       // chi^2: normal 2, thickness 1
    CHECK(std::sqrt(rms) == Approx(0.1*std::sqrt(2.)*std::sqrt(1 - 15/240.)).epsilon(0.02));
}

TEST_CASE("calibrateGlass refuses what is undetermined and says what it is", "[calibrate_glass]")
{
    Random random(350);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    const CalibrationScene scene = makeScene(camera, 5, random, 0.1);
    const Vec3d before = camera->window().normal;

    CHECK_THAT(whyNot(scene, true, camera, GLASS_FREE_DISTANCE), Catch::Contains("GLASS_FREE_DISTANCE"));
    CHECK_THAT(whyNot(scene, true, bareCamera(camera), 0), Catch::Contains("does not refract"));
    CHECK_THAT(whyNot(scene, true, camera, GLASS_SHARED_WINDOW), Catch::Contains("flags is 64"));
    CHECK_THAT(whyNot(scene, true, camera, GLASS_FREE_EXTRINSICS), Catch::Contains("flags is 32"));
    GlassWindow water;
    water.outerIndex = 1.333;
    CHECK_THAT(whyNot(scene, true, startCamera(camera, water), GLASS_FREE_INDEX), Catch::Contains("no layer"));
    GlassWindow window = camera->window();
    CHECK_THAT(thrown([&] { calibrateGlass(scene.object, scene.direct, scene.refracted, camera->cameraMatrix(),
                                           camera->distCoeffs(), window, noArray(), noArray(), GLASS_FREE_INTRINSICS); }),
               Catch::Contains("GLASS_FREE_INTRINSICS needs"));

    SECTION("thickness and index by one board seen once")
    {
        const CalibrationScene one = makeScene(camera, 1, random, 0.1);
        CHECK_THAT(whyNot(one, false, camera, GLASS_FREE_THICKNESS | GLASS_FREE_INDEX),
                   Catch::Contains("do not determine") && Catch::Contains("thickness[0]"));
    }
    SECTION("all layers of a laminate at once, even without noise")
    {
        const Ptr<RefractiveCamera> laminate = paperCamera(makeWindow(LAMINATE, random));
        CHECK_THAT(whyNot(makeScene(laminate, 5, random, 0), true, laminate, GLASS_FREE_THICKNESS),
                   Catch::Contains("do not determine") && Catch::Contains("thickness[0]") &&
                   Catch::Contains("thickness[2]") && Catch::Contains("combination"));
    }
    SECTION("points that fit in one line, or are too few")
    {
        CalibrationScene less = scene;
        less.object.resize(1);
        less.refracted.resize(1);
        less.direct.clear();
        less.object[0].resize(6);
        less.refracted[0].resize(6);
        CHECK_THAT(whyNot(less, true, camera, 0), Catch::Contains("view 0"));
        less.object[0] = { scene.object[0][0], scene.object[0][5], scene.object[0][24], scene.object[0][29] };
        less.refracted[0] = { scene.refracted[0][0], scene.refracted[0][5], scene.refracted[0][24],
                              scene.refracted[0][29] };
        CHECK_THAT(whyNot(less, true, camera, 0), Catch::Contains("8 equations for 8 unknowns"));
        less.object[0].pop_back();
        less.refracted[0].pop_back();
        CHECK_THAT(whyNot(less, true, camera, 0), Catch::Contains("fewer than 4"));
    }
    SECTION("views that do not match")
    {
        CalibrationScene bad = scene;
        bad.refracted.pop_back();
        CHECK_THAT(whyNot(bad, true, camera, 0), Catch::Contains("imagePointsRefracted has 4 views"));
        bad = scene;
        bad.direct[2].pop_back();
        CHECK_THAT(whyNot(bad, true, camera, 0), Catch::Contains("imagePointsDirect[2] has 29 points"));
        bad = scene;
        bad.object[2][3].x = NaN;
        CHECK_THAT(whyNot(bad, true, camera, 0), Catch::Contains("objectPoints[2]"));
        bad.object.clear();
        CHECK_THAT(whyNot(bad, true, camera, 0), Catch::Contains("objectPoints is empty"));
        bad = scene;
        bad.refracted.clear();
        CHECK_THAT(whyNot(bad, true, camera, 0), Catch::Contains("imagePointsRefracted has no point"));
    }
    SECTION("a window beyond the target")
    {
        window.distance = 900;
        CHECK_THAT(whyNot(scene, true, startCamera(camera, window), 0), Catch::Contains("distance"));
    }
    SECTION("too few iterations")
    {
        const Ptr<RefractiveCamera> start = startCamera(camera, straight(paper::pane()));
        CHECK_THAT(thrown([&] { calibrateGlass(scene.object, scene.direct, scene.refracted, start, noArray(), noArray(), 0,
                                               TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 1, 1e-12)); }),
                   Catch::Contains("did not converge in 1 iterations"));
        CHECK(start->window().normal == Vec3d(0, 0, 1));
        for (const TermCriteria& bad : { TermCriteria(0, 10, 1e-9), TermCriteria(TermCriteria::COUNT, 0, 0),
                                         TermCriteria(TermCriteria::EPS, 0, -1), TermCriteria(TermCriteria::EPS, 0, INF) })
            CHECK_THAT(thrown([&] { calibrateGlass(scene.object, scene.direct, scene.refracted, start, noArray(), noArray(),
                                                   0, bad); }), Catch::Contains("criteria."));
        calibrateGlass(scene.object, scene.direct, scene.refracted, startCamera(camera, paper::pane()), noArray(),
                       noArray(), 0, TermCriteria(TermCriteria::EPS, 0, 1e-9));
        calibrateGlass(scene.object, scene.direct, scene.refracted, start, noArray(), noArray(), 0,
                       TermCriteria(TermCriteria::COUNT, 1, 0));
    }
    CHECK(camera->window().normal == before);       // a refusal leaves the start alone
}

TEST_CASE("A loose epsilon ends at the same minimum", "[calibrate_glass]")
{
    Random random(375);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    const CalibrationScene scene = makeScene(camera, 4, random, 0.1);
    const auto found = [&](bool pairs, double epsilon, int flags)
    {
        const Ptr<RefractiveCamera> start = startCamera(camera, straight(camera->window()));
        calibrateGlass(scene.object, pairs ? scene.direct : std::vector<std::vector<Point2d> >(), scene.refracted, start,
                       noArray(), noArray(), flags, TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 300, epsilon));
        return start->window().normal;
    };
    CAPTURE(seed());
    for (bool pairs : { true, false })
    {
        const Vec3d tight = found(pairs, 1e-12, 0);
        for (double epsilon : { 1e-9, 1e-6, 1e-3, 1. })
        {
            CAPTURE(pairs, epsilon);
            CHECK(angleBetween(found(pairs, epsilon, 0), tight) < 1e-3);    // degrees
        }
    }
    CHECK(angleBetween(found(true, 1e-4, GLASS_FREE_THICKNESS | GLASS_FREE_INTRINSICS),
                       found(true, 1e-12, GLASS_FREE_THICKNESS | GLASS_FREE_INTRINSICS)) < 1e-3);
}

TEST_CASE("A distance that ends on zero is held there", "[calibrate_glass]")
{
    Random random(360);
    GlassWindow window({ -0.1, 0.2, 1 }, 8, 1.49, 0, 1.333);
    const Ptr<RefractiveCamera> camera = paperCamera(window);
    window.distance = 30;
    int onBound = 0;
    for (int run = 0; run < 12; run++)
    {
        CAPTURE(run, seed());
        const CalibrationScene scene = makeScene(camera, 6, random, 0.3);
        const Ptr<RefractiveCamera> found = startCamera(camera, straight(window));
        calibrate(scene, run % 2 == 0, found, GLASS_FREE_DISTANCE);
        CHECK(found->window().distance < 5);
        onBound += found->window().distance == 0;
    }
    CHECK(onBound > 0);
}

TEST_CASE("One view through a pane: the search finds the deeper of two minima", "[calibrate_glass]")
{
    for (int run = 0; run < 20; run++)
    {
        Random random(3700 + run);
        CAPTURE(run, seed());
        const Ptr<RefractiveCamera> camera = paperCamera(makeWindow(PANE_IN_AIR, random));
        const CalibrationScene scene = makeScene(camera, 1, random, 0.1);
        const double fromTruth = calibrate(scene, false, startCamera(camera, camera->window()));
        const double fromStraight = calibrate(scene, false, startCamera(camera, straight(camera->window())));
        CHECK(fromStraight <= fromTruth + 1e-6);
    }
}
