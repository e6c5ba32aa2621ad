// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibration_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

TEST_CASE("The pose of a perfectly seen target is exact, whatever lens and window", "[pnp]")
{
    double largest = 0;
    for (WindowKind kind : allWindows())
        for (const LensKind& lens : allLenses())
            for (bool planar : { true, false })
            {
                Random random(200 + kind);
                CAPTURE(name(kind), lens.name, planar, seed());
                const Ptr<RefractiveCamera> camera = makeCamera(lens, makeWindow(kind, random));
                const std::vector<Point3d> object = planar ? board() : cloud(random);
                const Vec3d rvec(0.3, -0.4, 0.2), tvec(20, -10, 600);
                Mat r, t, error;
                REQUIRE(refractiveSolvePnP(object, seen(object, rvec, tvec, camera, random, 0), camera, r, t, false, error));
                CHECK(error.at<double>(0) < 1e-7);
                largest = std::max(largest, std::max(norm(t, Mat(tvec))/norm(tvec), norm(r, Mat(rvec))));
                CHECK(norm(t, Mat(tvec)) < 1e-6*norm(tvec));
                CHECK(norm(r, Mat(rvec)) < 1e-6);
            }
    printNumber("refractiveSolvePnP on perfect data, relative", largest, "");
}

TEST_CASE("A target that nearly touches a steep wall has its pose", "[pnp]")
{
    // As a pinhole at their mean origin has them, its points are before the wall.
    int count = 0;
    for (int trial = 0; trial < trials(40); trial++)
    {
        Random random(240 + trial);
        const double tilt = random.uniform(0.6, 1.25), azimuth = random.uniform(0, 2*CV_PI), GAP = 3;
        const Vec3d normal(std::sin(tilt)*std::cos(azimuth), std::sin(tilt)*std::sin(azimuth), std::cos(tilt));
        GlassWindow window(normal, 4, 1.49, 0, 1.33);
        Vec3d rvec = random.vector(0.3);
        const Vec3d tvec = Vec3d(0, 0, 700) + random.vector(20);
        Matx33d R;
        Rodrigues(rvec, R);
        double nearest = DBL_MAX;
        const std::vector<Point3d> object = board(9, 6, 16);
        for (const Point3d& p : object)
            nearest = std::min(nearest, window.normal.dot(R*Vec3d(p) + tvec));
        window.distance = nearest - GAP - window.thickness[0];
        const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(2500, 0, 1151.5, 0, 2500, 859.5, 0, 0, 1), noArray(), window);
        std::vector<Point2d> pixels;
        Mat status, r, t;
        refractiveProjectPoints(object, rvec, tvec, camera, pixels, status);
        if (countNonZero(status) > 0)
            continue;
        CAPTURE(trial, tilt, azimuth, seed());
        REQUIRE(refractiveSolvePnP(object, pixels, camera, r, t));
        CHECK(norm(r, Mat(rvec)) < 1e-6);
        CHECK(norm(t, Mat(tvec)) < 1e-6*norm(tvec));
        count++;
    }
    CHECK(count >= 20);
}

TEST_CASE("A board exactly across the view has its pose", "[pnp]")
{
    for (int trial = 0; trial < trials(200); trial++)
    {
        Random random(270 + trial);
        GlassWindow window(Vec3d(0, 0, 1) + (trial % 2)*Vec3d(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0), 12, 1.5, 30, 1.333);
        const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(1100, 0, 640, 0, 1100, 480, 0, 0, 1), noArray(), window);
        const Vec3d n = normalize(window.normal), across = Vec3d(0, 0, 1).cross(n);
        const double sine = norm(across), turn = random.uniform(-3, 3);
        Matx33d parallel, spin;
        Rodrigues(sine > 0 ? across*(std::asin(sine)/sine) : Vec3d(), parallel);
        Rodrigues(Vec3d(0, 0, turn), spin);
        const Vec3d tvec = n*random.uniform(50, 800);
        const std::vector<Point3d> object = board(6, 5, random.uniform(1, 6));
        Vec3d rvec, r, t;
        Rodrigues(parallel*spin, rvec);
        std::vector<Point2d> pixels;
        Mat status;
        refractiveProjectPoints(object, rvec, tvec, camera, pixels, status);
        CAPTURE(trial, turn, tvec, object[1].x, seed());
        REQUIRE(countNonZero(status) == 0);
        REQUIRE(refractiveSolvePnP(object, pixels, camera, r, t));
        CHECK(norm(t - tvec) < 1e-6*norm(tvec));
        std::vector<Point2d> again;
        refractiveProjectPoints(object, r, t, camera, again, status);
        CHECK(norm(again, pixels, NORM_INF) < 1e-7);
    }
}

TEST_CASE("Targets of any unit have their pose", "[pnp]")
{
    Random random(215);
    for (bool flat : { true, false })
        for (double unit : { 1e-6, 1e-3, 1., 1e3, 1e6, 1e9 })
        {
            GlassWindow window = paper::pane();
            window.distance *= unit;
            for (double& thickness : window.thickness)
                thickness *= unit;
            const Ptr<RefractiveCamera> camera = paperCamera(window);
            const Vec3d rvec(0.3, -0.2, 0.1), tvec(10*unit, 20*unit, 700*unit);
            std::vector<Point3d> object = board();
            for (Point3d& p : object)
                p = Point3d(p.x, p.y, flat ? 0 : random.uniform(-20, 20))*unit;
            Mat r, t;
            CAPTURE(flat, unit, seed());
            const std::vector<Point2d> pixels = seen(object, rvec, tvec, camera, random, 0);
            REQUIRE(refractiveSolvePnP(object, pixels, camera, r, t));
            CHECK(norm(r, Mat(rvec)) < 1e-8);
            CHECK(norm(t, Mat(tvec)) < 1e-7*norm(tvec));
            REQUIRE(refractiveSolvePnPRansac(object, pixels, camera, r, t));
            CHECK(norm(r, Mat(rvec)) < 1e-8);
            CHECK(norm(t, Mat(tvec)) < 1e-7*norm(tvec));
        }
}

TEST_CASE("A target in space that is small in the image has its pose", "[pnp]")
{
    Random random(212);
    const GlassWindow steep({ 0.4, 0.1, 1 }, 20, 1.52, 100, 1.333);
    for (const GlassWindow& window : { GlassWindow(), steep })
        for (double size : { 20., 5., 2., 0.5, 0.02 })
            for (int count : { 5, 6, 18 })
            {
                const Matx33d K(12000, 0, 1223.5, 0, 12000, 1023.5, 0, 0, 1);
                const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, noArray(), window);
                std::vector<Point3d> object;
                for (int i = 0; i < count; i++)
                    object.push_back(Point3d(size*random.vector(0.5)));
                const Vec3d rvec = random.vector(1), tvec(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(500, 900));
                CAPTURE(window.outerIndex, size, count, seed());
                Vec3d found, t;
                REQUIRE(refractiveSolvePnP(object, seen(object, rvec, tvec, camera, random, 0), camera, found, t));
                CHECK(norm(t - tvec) < 1e-5*norm(tvec));
                Matx33d R, truth;
                Rodrigues(found, R);
                Rodrigues(rvec, truth);
                CHECK(norm(R - truth) < 1e-5);
            }
}

TEST_CASE("A wide lens sees the target beyond 90 degrees", "[pnp]")
{
    Random random(210);
    const LensKind& fisheye = lensNamed("fisheye");
    const Ptr<RefractiveCamera> camera = makeCamera(fisheye, GlassWindow());
    const std::vector<Point3d> object = board();
    const Vec3d rvec(0, 1.5, 0), tvec(500, 30, 40);
    Mat r, t, error;
    REQUIRE(refractiveSolvePnP(object, seen(object, rvec, tvec, camera, random, 0), camera, r, t, false, error));
    CHECK(error.at<double>(0) < 1e-7);
    CHECK(norm(t, Mat(tvec)) < 1e-4);
}

TEST_CASE("Noise, missing points and a guess", "[pnp]")
{
    Random random(220);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    const std::vector<Point3d> object = board();
    const Vec3d rvec(0.3, -0.4, 0.2), tvec(20, -10, 600);
    std::vector<Point2d> pixels = seen(object, rvec, tvec, camera, random, 0.1);
    Mat r, t, r2, t2;
    std::vector<double> error, error2;
    REQUIRE(refractiveSolvePnP(object, pixels, camera, r, t, false, error));
    REQUIRE(error.size() == 1);
    CHECK(error[0] == Approx(0.1).epsilon(0.25));
    CHECK(norm(t, Mat(tvec)) < 1);

    SECTION("the overload agrees")
    {
        CHECK(refractiveSolvePnP(object, pixels, camera->cameraMatrix(), camera->distCoeffs(), camera->window(), r2, t2,
                                 false, error2));
        CHECK(error2 == error);
        CHECK(largestDifference(t, t2) == 0);
    }
    SECTION("a guess leads to the same minimum")
    {
        r2 = r + 0.02;
        t2 = t + 3;
        REQUIRE(refractiveSolvePnP(object, pixels, camera, r2, t2, true, error2));
        CHECK(error2[0] == Approx(error[0]).epsilon(1e-9));
        CHECK(largestDifference(t, t2) < 1e-5);
    }
    SECTION("points that were not seen are left out")
    {
        std::vector<Point3d> fewer(object.begin() + 4, object.end());
        std::vector<Point2d> fewerPixels(pixels.begin() + 4, pixels.end());
        refractiveSolvePnP(fewer, fewerPixels, camera, r, t);
        for (int i = 0; i < 4; i++)
            pixels[i] = Point2d(NaN, NaN);
        refractiveSolvePnP(object, pixels, camera, r2, t2);
        CHECK(largestDifference(t, t2) < 1e-6);
    }
    SECTION("three points and a guess")
    {
        const std::vector<Point3d> three = { object[0], object[5], object[25] };
        r2 = r + 0.001;
        t2 = t + 0.1;
        REQUIRE(refractiveSolvePnP(three, std::vector<Point2d>{ pixels[0], pixels[5], pixels[25] }, camera, r2, t2, true,
                                   error2));
        CHECK(error2[0] < 1e-6);
    }
}

TEST_CASE("The error is the one that cv::solvePnPGeneric returns", "[pnp]")
{
    Random random(225);
    const Ptr<RefractiveCamera> camera = paperCamera(GlassWindow());
    const std::vector<Point3d> object = board();
    const std::vector<Point2d> pixels = seen(object, Vec3d(0.3, -0.4, 0.2), Vec3d(20, -10, 600), camera, random, 0.1);
    std::vector<Mat> rvecs, tvecs, rvecs2, tvecs2;
    std::vector<double> errors, errors2;
    const Mat K = camera->cameraMatrix(), D = camera->distCoeffs();
    REQUIRE(refractiveSolvePnPGeneric(object, pixels, K, D, GlassWindow(), rvecs, tvecs, false, noArray(), noArray(),
                                      errors) > 0);
    REQUIRE(solvePnPGeneric(object, pixels, K, D, rvecs2, tvecs2, true, SOLVEPNP_ITERATIVE, rvecs[0], tvecs[0],
                            errors2) == 1);
    CHECK(errors[0] == Approx(errors2[0]).epsilon(1e-4));
    CHECK(largestDifference(tvecs[0], tvecs2[0]) < 1e-2);
}

TEST_CASE("Both poses of a flat target", "[pnp]")
{
    Random random(226);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    const std::vector<Point3d> flat = board();
    const Vec3d rvec(0.3, -0.4, 0.2), tvec(20, -10, 1500);
    const std::vector<Point2d> pixels = seen(flat, rvec, tvec, camera, random, 0.1);
    std::vector<Vec3d> rvecs, tvecs;
    std::vector<double> errors;
    REQUIRE(refractiveSolvePnPGeneric(flat, pixels, camera, rvecs, tvecs, false, noArray(), noArray(), errors) == 2);
    REQUIRE(rvecs.size() == 2);
    REQUIRE(tvecs.size() == 2);
    REQUIRE(errors.size() == 2);
    CHECK(errors[0] < errors[1]);
    CHECK(norm(rvecs[0] - rvec) < 0.02);
    CHECK(norm(rvecs[1] - rvec) > 0.2);
    CHECK(norm(tvecs[1] - tvec) < 30);

    Mat r, t;
    REQUIRE(refractiveSolvePnP(flat, pixels, camera, r, t));
    CHECK(norm(t, Mat(tvecs[0])) == 0);
    // From the second pose's neighbourhood the second is found.
    std::vector<Mat> one, oneT;
    REQUIRE(refractiveSolvePnPGeneric(flat, pixels, camera, one, oneT, true, rvecs[1] + Vec3d(0.01, 0, 0), tvecs[1]) == 1);
    CHECK(norm(oneT[0], Mat(tvecs[1])) < 1e-3);
    // A solid has one.
    const std::vector<Point3d> solid = cloud(random);
    CHECK(refractiveSolvePnPGeneric(solid, seen(solid, rvec, tvec, camera, random, 0.1), camera, one, oneT) == 1);
    CHECK(refractiveSolvePnPGeneric(flat, std::vector<Point2d>(flat.size(), Point2d(NaN, NaN)), camera, one, oneT, false,
                                    noArray(), noArray(), errors) == 0);
    CHECK((one.empty() && oneT.empty() && errors.empty()));
}

TEST_CASE("Few points in space: the least of their minima", "[pnp]")
{
    GlassWindow thick = paper::pane();
    thick.normal = normalize(Vec3d(0.5, -0.2, 1));
    thick.thickness[0] = 100;
    const int TRIALS = trials(600);
    for (const GlassWindow& window : { GlassWindow(), thick, GlassWindow({ 0.3, 0.1, 1 }, 40, 1.49, 250, 1.333) })
        for (int count : { 4, 5 })
        {
            Random random(240 + count);
            const Ptr<RefractiveCamera> camera = paperCamera(window);
            int wrong = 0;
            size_t minima = 0;
            for (int trial = 0; trial < TRIALS; trial++)
            {
                std::vector<Point3d> object;
                for (int i = 0; i < count; i++)
                    object.push_back(Point3d(random.uniform(-90, 90), random.uniform(-70, 70), random.uniform(-60, 60)));
                const Vec3d rvec = normalize(random.vector(1))*random.uniform(0, 3);
                const Vec3d tvec(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(500, 800));
                std::vector<Vec3d> rvecs, tvecs;
                std::vector<double> errors;
                refractiveSolvePnPGeneric(object, seen(object, rvec, tvec, camera, random, 0), camera, rvecs, tvecs, false,
                                          noArray(), noArray(), errors);
                wrong += errors.empty() || !(errors[0] < 1e-6);
                minima += errors.size();
            }
            CAPTURE(window.outerIndex, count, seed());
            printNumber("minima of " + std::to_string(count) + " points, on average", (double)minima/TRIALS, "");
            CHECK(wrong == 0);
            CHECK(minima > (size_t)TRIALS);
        }
}

//! x^T C^-1 x of a pose's six errors.
static double chiSquare(const Mat& rvec, const Mat& tvec, const Vec3d& trueRvec, const Vec3d& trueTvec, const Mat& covariance)
{
    const Vec3d r = Vec3d(rvec.ptr<double>()) - trueRvec, t = Vec3d(tvec.ptr<double>()) - trueTvec;
    const Vec6d off(r[0], r[1], r[2], t[0], t[1], t[2]);
    return off.dot(Matx66d(covariance.ptr<double>()).inv()*off);
}

TEST_CASE("Poses are as good as is stated, noise and an inexact camera included", "[pnp]")
{
    Random random(250);
    GlassWindow window({ 0.2, -0.05, 1 }, 15, 1.49, 60, 1.333);
    const Ptr<RefractiveCamera> camera = paperCamera(window);
    const std::vector<String> names = camera->parameterNames();
    const int count = (int)names.size();
    Mat cameraCovariance = Mat::zeros(count, count, CV_64F);
    const double SIGMA_INDEX = 0.002, SIGMA = 0.1;
    cameraCovariance.at<double>(count - 1, count - 1) = SIGMA_INDEX*SIGMA_INDEX;
    REQUIRE(names.back() == "outerIndex");
    const int TRIALS = trials(200);
    double given = 0, estimated = 0, ofRansac = 0, inexact = 0, forgotten = 0;
    const std::vector<Point3d> object = cloud(random);
    for (int trial = 0; trial < TRIALS; trial++)
    {
        const Vec3d rvec = random.vector(0.4), tvec(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(500, 800));
        const std::vector<Point2d> pixels = seen(object, rvec, tvec, camera, random, SIGMA);
        Mat r, t, error, C;
        std::vector<int> inliers;
        REQUIRE(refractiveSolvePnP(object, pixels, camera, r, t, false, error, C, SIGMA));
        given += chiSquare(r, t, rvec, tvec, C)/TRIALS;
        REQUIRE(refractiveSolvePnP(object, pixels, camera, r, t, false, error, C));
        estimated += chiSquare(r, t, rvec, tvec, C)/TRIALS;
        REQUIRE(refractiveSolvePnPRansac(object, pixels, camera, r, t, false, 100, 8, 0.99, inliers, C, SIGMA));
        ofRansac += chiSquare(r, t, rvec, tvec, C)/TRIALS;
        GlassWindow other = window;
        other.outerIndex += random.normal(SIGMA_INDEX);
        const Ptr<RefractiveCamera> wrong = paperCamera(other);
        REQUIRE(refractiveSolvePnP(object, pixels, wrong, r, t, false, error, C, SIGMA, cameraCovariance));
        inexact += chiSquare(r, t, rvec, tvec, C)/TRIALS;
        std::vector<Mat> rvecs, tvecs, covariances;
        const int poses = refractiveSolvePnPGeneric(object, pixels, wrong, rvecs, tvecs, false, noArray(), noArray(), error,
                                                    covariances, SIGMA);
        REQUIRE(poses > 0);
        REQUIRE(poses == (int)covariances.size());
        forgotten += chiSquare(rvecs[0], tvecs[0], rvec, tvec, covariances[0])/TRIALS;
    }
    CAPTURE(seed());
    for (double chi2 : { given, estimated, ofRansac, inexact, forgotten })
        printNumber("chi^2 of a pose's six", chi2, "");
    const double spread = 3*std::sqrt(12./TRIALS);
    CHECK(std::abs(given - 6) < spread);
    CHECK(std::abs(estimated - 6) < spread + 0.6);      // of few residuals: Hotelling's T^2
    CHECK(std::abs(ofRansac - 6) < spread + 0.3);
    CHECK(std::abs(inexact - 6) < spread);
    CHECK(forgotten > 7.5);

    Mat r, t, C;
    const std::vector<Point2d> pixels = seen(object, Vec3d(), Vec3d(0, 0, 600), camera, random, SIGMA);
    CHECK_THAT(thrown([&] { refractiveSolvePnP(object, pixels, camera, r, t, false, noArray(), C, -1); }),
               Catch::Contains("sigma is -1"));
    CHECK_THAT(thrown([&] { refractiveSolvePnP(object, pixels, camera, r, t, false, noArray(), C, 0, Mat::eye(3, 3, CV_64F)); }),
               Catch::Contains("cameraCovariance is 3x3"));
    CHECK_FALSE(refractiveSolvePnP(object, std::vector<Point2d>(object.size(), Point2d(NaN, NaN)), camera, r, t, false,
                                   noArray(), C));
    CHECK(C.empty());
}

TEST_CASE("What is not wanted is left out, also a covariance", "[pnp]")
{
    Random random(255);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, noArray(), paper::pane());
    const std::vector<Point3d> object = board();
    const Vec3d rvec(0.2, -0.1, 0.3), tvec(-60, -40, 600);
    const std::vector<Point2d> pixels = seen(object, rvec, tvec, camera, random, 0.1);
    Mat r, t, C, plain, error;
    std::vector<Mat> rs, ts;
    CHECK(refractiveSolvePnP(object, pixels, camera, plain, t));
    CHECK(refractiveSolvePnP(object, pixels, camera, r, t, false, noArray(), noArray(), 0.1));
    CHECK(norm(r, plain) == 0);
    CHECK(refractiveSolvePnPGeneric(object, pixels, camera, rs, ts, false, noArray(), noArray(), noArray(), noArray(), 0.1) >= 1);
    CHECK(norm(rs[0], plain) == 0);
    CHECK(refractiveSolvePnPRansac(object, pixels, camera, r, t, false, 100, 8.f, 0.99, noArray(), noArray(), 0.1));
    CHECK(norm(r, plain) < 1e-3);

    const Matx33d R = Matx33d::eye();
    std::vector<Point3d> cloud;
    for (int i = 0; i < 40; i++)
        cloud.push_back(Point3d(random.uniform(-150, 150), random.uniform(-120, 120), random.uniform(600, 900)));
    const std::vector<Point2d> first = seen(cloud, Vec3d(), Vec3d(), camera, random, 0.1);
    const std::vector<Point2d> second = seen(cloud, Vec3d(0, 0.1, 0), Vec3d(-80, 3, 5), camera, random, 0.1);
    Mat R2, T2;
    Vec2d interval;
    CHECK(refractiveRecoverPose(first, second, camera, camera->clone(), R2, T2, 0.999, 1., noArray(), noArray(), interval) > 30);
    CHECK(norm(R2, R) < 0.2);
}

TEST_CASE("Three points: all poses; a fourth tells the right one", "[pnp]")
{
    Random random(260);
    GlassWindow thick = paper::pane();
    thick.normal = normalize(Vec3d(0.5, -0.2, 1));
    thick.thickness[0] = 100;
    for (const GlassWindow& window : { GlassWindow(), thick })
    {
        const Ptr<RefractiveCamera> camera = paperCamera(window);
        for (int trial = 0; trial < 50; trial++)
        {
            std::vector<Point3d> object;
            for (int i = 0; i < 4; i++)
                object.push_back(Point3d(random.uniform(-90, 90), random.uniform(-70, 70), random.uniform(-60, 60)));
            const Vec3d rvec = random.vector(0.5), tvec(random.uniform(-20, 20), random.uniform(-20, 20), 600);
            const std::vector<Point2d> pixels = seen(object, rvec, tvec, camera, random, 0);
            std::vector<Vec3d> rvecs, tvecs;
            CAPTURE(trial, window.thickness.size(), seed());
            const int count = refractiveSolveP3P(object, pixels, camera, rvecs, tvecs);
            REQUIRE(count > 0);
            CHECK(norm(rvecs[0] - rvec) < 1e-5);
            CHECK(norm(tvecs[0] - tvec) < 1e-3);
            object.pop_back();
            const std::vector<Point2d> three(pixels.begin(), pixels.end() - 1);
            CHECK(refractiveSolveP3P(object, three, camera->cameraMatrix(), camera->distCoeffs(), window, rvecs, tvecs) >= count);
            for (size_t k = 0; k < rvecs.size(); k++)
            {
                std::vector<Point2d> again;
                refractiveProjectPoints(object, rvecs[k], tvecs[k], camera, again);
                CHECK(norm(again, three, NORM_INF) < 1e-5);
            }
            if (window.thickness.empty() && trial < 10)
            {
                std::vector<Mat> r, t;
                solveP3P(object, three, camera->cameraMatrix(), camera->distCoeffs(), r, t, SOLVEPNP_AP3P);
                for (size_t k = 0; k < t.size(); k++)       // of which some are none, behind the camera
                {
                    std::vector<Point2d> again;
                    std::vector<uchar> status;
                    refractiveProjectPoints(object, r[k], t[k], camera, again, status);
                    const bool isPose = countNonZero(status) == 0 && norm(again, three, NORM_INF) < 1e-3;
                    CHECK((!isPose || std::any_of(tvecs.begin(), tvecs.end(), [&](const Vec3d& ours)
                                                  { return norm(Mat(ours), t[k]) < 1e-2; })));
                }
            }
        }
    }
    const Ptr<RefractiveCamera> camera = paperCamera(thick);
    std::vector<Vec3d> rvecs(2), tvecs(2);
    CHECK(refractiveSolveP3P(std::vector<Point3d>(), std::vector<Point2d>(), camera, rvecs, tvecs) == 0);
    CHECK((rvecs.empty() && tvecs.empty()));
    const std::vector<Point2d> unseen = { { 600, 500 }, { NaN, 4 }, { 700, 400 } };
    CHECK(refractiveSolveP3P(std::vector<Point3d>{ { 0, 0, 0 }, { 50, 0, 0 }, { 0, 50, 0 } }, unseen, camera, rvecs, tvecs) == 0);
    CHECK_THAT(thrown([&] { refractiveSolveP3P(board(), std::vector<Point2d>(30), camera, rvecs, tvecs); }),
               Catch::Contains("objectPoints has 30 points; it must have at most 4"));
}

TEST_CASE("No pose is false, bad arguments are named", "[pnp]")
{
    Random random(230);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    const std::vector<Point3d> object = board();
    const std::vector<Point2d> pixels = seen(object, Vec3d(), Vec3d(0, 0, 600), camera, random, 0);
    Mat r = Mat(Vec3d(1, 2, 3), true), t;
    std::vector<double> error(3);
    const auto nothing = [&](const std::vector<Point3d>& o, const std::vector<Point2d>& p)
    { return !refractiveSolvePnP(o, p, camera, r, t, false, error) && t.empty() && r.at<double>(2) == 3 && error.empty(); };

    CHECK(nothing({ object.begin(), object.begin() + 6 }, { pixels.begin(), pixels.begin() + 6 }));     // one row
    CHECK(nothing(std::vector<Point3d>(6, object[0]), std::vector<Point2d>(6, pixels[0])));
    CHECK(nothing(object, std::vector<Point2d>(object.size(), Point2d(NaN, NaN))));
    for (const Point2d& pixel : { Point2d(1e6, 1e6), Point2d(640.3, 480.7) })
        for (const std::vector<Point3d>& points : { object, cloud(random) })
            CHECK(nothing(points, std::vector<Point2d>(points.size(), pixel)));     // also outside the lens model

    const auto why = [&](const std::vector<Point3d>& o, const std::vector<Point2d>& p)
    { return thrown([&] { refractiveSolvePnP(o, p, camera, r, t); }); };
    CHECK_THAT(why(object, { pixels[0] }), Catch::Contains("objectPoints has 30 points, imagePoints 1"));
    CHECK_THAT(why({ object[0] }, { pixels[0] }), Catch::Contains("at least 4"));
    CHECK(nothing({}, {}));
    CHECK_THAT(why(std::vector<Point3d>(30, Point3d(NaN, 0, 0)), pixels), Catch::Contains("must be finite"));
    CHECK_THAT(thrown([&] { refractiveSolvePnP(object, pixels, Ptr<RefractiveCamera>(), r, t); }),
               Catch::Contains("camera is empty"));
}

TEST_CASE("Three points that are left of more have no pose, unless one is guessed", "[pnp]")
{
    // They have up to eight exact ones: any would be returned with an error of 0.
    Random random(231);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    const Vec3d rvec(0.2, -0.1, 0.3), tvec(10, 20, 700);
    const Point2d missing(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN());
    for (bool areCopies : { false, true })
        for (int trial = 0; trial < 20; trial++)
        {
            CAPTURE(areCopies, trial, seed());
            std::vector<Point3d> object;
            for (int i = 0; i < 5; i++)
                object.push_back({ random.uniform(-80, 80), random.uniform(-80, 80), random.uniform(-30, 30) });
            std::vector<Point2d> pixels = seen(object, rvec, tvec, camera, random, 0);
            for (int i : { 1, 4 })
            {
                object[i] = areCopies ? object[0] : object[i];
                pixels[i] = areCopies ? pixels[0] : missing;
            }
            Mat r, t, error, covariance;
            std::vector<Mat> rs, ts;
            CHECK_FALSE(refractiveSolvePnP(object, pixels, camera, r, t, false, error));
            CHECK_FALSE(refractiveSolvePnP(object, pixels, camera, r, t, false, error, covariance, 0.3));
            CHECK((r.empty() && t.empty() && error.empty() && covariance.empty()));
            CHECK(refractiveSolvePnPGeneric(object, pixels, camera, rs, ts) == 0);
            r = Mat(rvec + random.vector(0.01), true);
            t = Mat(tvec + random.vector(1), true);
            REQUIRE(refractiveSolvePnP(object, pixels, camera, r, t, true, error));
            CHECK(norm(t, Mat(tvec)) < 1e-6*norm(tvec));
        }
}
