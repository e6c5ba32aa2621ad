// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Arguments of the calibrators that say little: views without an image, cameras without a window, flags that do not concern them.
#include "bundle_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

//! The same with a view of nothing before one of them.
template<typename T>
void insertEmpty(std::vector<T>& of, int at) { of.insert(of.begin() + at, T()); }

} // namespace

TEST_CASE("A view without an image is as if it were not there", "[calibrate_arguments]")
{
    CAPTURE(seed());
    Random random(3500);
    const int EMPTY = 2;
    for (bool isPaired : { true, false })
        for (int flags : { 0, (int)GLASS_ROBUST })
        {
            CAPTURE(isPaired, flags);
            const RigTruth truth = makeRig(2, { 0, 1 }, isPaired ? 1. : 1.333);
            const RigScene scene = makeRigScene(truth, 6, random, 0.1);
            RigCall without(truth, scene, isPaired), with(truth, scene, isPaired);
            with.object.insert(with.object.begin() + EMPTY, board());
            for (int c = 0; c < 2; c++)
            {
                insertEmpty(with.refracted[c], EMPTY);
                if (isPaired)
                    insertEmpty(with.direct[c], EMPTY);
            }
            // Not taken, or nothing of it seen.
            with.refracted[1][EMPTY] = Mat((int)board().size(), 1, CV_64FC2, Scalar::all(NaN));
            const double rms = without.run(flags | GLASS_FREE_EXTRINSICS);
            CHECK(with.run(flags | GLASS_FREE_EXTRINSICS) == rms);
            CHECK(largestDifference(with.covariance, without.covariance) == 0);
            for (int c = 0; c < 2; c++)
                CHECK(with.cameras[c]->window().normal == without.cameras[c]->window().normal);
            CHECK(with.rvecs.size() == 7);
            CHECK(std::isnan(with.rvecs[EMPTY].at<double>(0)));
            CHECK(norm(with.tvecs[EMPTY + 1], without.tvecs[EMPTY]) == 0);
            CHECK(with.perViewErrors.rows == 7);
            CHECK(countNonZero(with.imageStatus.row(EMPTY) != GLASS_IMAGE_ABSENT) == 0);
            CHECK(with.inliers.size() == 7*4);
            CHECK(with.inliers[4*EMPTY + 1].empty());
            CHECK(norm(with.inliers[4*(EMPTY + 1) + 1], without.inliers[4*EMPTY + 1]) == 0);
            CHECK(with.perViewErrors.at<double>(EMPTY + 1, 1) == without.perViewErrors.at<double>(EMPTY, 1));

            // Of one camera, with the derivatives; and what is wrong with another view has its number.
            std::vector<Mat> rvecs, tvecs;
            Mat deviations, covariance, errors, jacobian, fewer;
            const std::vector<Mat> none;
            RigCall again(truth, scene, isPaired);
            calibrateGlass(with.object, isPaired ? with.direct[0] : none, with.refracted[0], again.cameras[0], rvecs, tvecs, deviations,
                           covariance, errors, jacobian, flags);
            RigCall last(truth, scene, isPaired);
            calibrateGlass(without.object, isPaired ? without.direct[0] : none, without.refracted[0], last.cameras[0], rvecs, tvecs,
                           deviations, covariance, errors, fewer, flags);
            REQUIRE(jacobian.cols == fewer.cols + 6);
            const int first = (int)again.cameras[0]->parameterNames().size();
            CHECK(norm(jacobian.colRange(first + 6*EMPTY, first + 6*EMPTY + 6)) == 0);
            CHECK(norm(jacobian.colRange(0, first + 6*EMPTY), fewer.colRange(0, first + 6*EMPTY)) == 0);
            CHECK(norm(jacobian.colRange(first + 6*EMPTY + 6, jacobian.cols), fewer.colRange(first + 6*EMPTY, fewer.cols)) == 0);
            if (flags != 0)
                continue;
            RigCall few(truth, scene, isPaired);
            few.object.insert(few.object.begin() + EMPTY, board());
            for (int c = 0; c < 2; c++)
            {
                insertEmpty(few.refracted[c], EMPTY);
                if (isPaired)
                    insertEmpty(few.direct[c], EMPTY);
                for (int i = 3; i < few.refracted[c][4].rows; i++)
                    few.refracted[c][4].at<Point2d>(i) = Point2d(NaN, NaN);
                if (isPaired)
                    few.direct[c][4] = Mat();
            }
            try
            {
                few.run(0);
                CHECK(false);
            }
            catch (const CalibrationError& e)
            {
                CHECK(e.cause == CalibrationError::NO_POSE);
                CHECK(e.view == 4);
                CHECK_THAT(e.err, Contains("view 4"));
            }
        }
}

TEST_CASE("A view without an image counts for nothing in a bundle, too", "[calibrate_arguments][bundle]")
{
    CAPTURE(seed());
    Random random(3510);
    const RigTruth truth = makeRig(2, { 0, 1 }, 1.333);
    const BundleScene scene = makeMovingScene(truth, 4, 40, random, 0.1);
    for (int empty : { 0, 2, 4 })
    {
        CAPTURE(empty);
        Random start1(3511), start2(3511);
        BundleCall without(truth, scene, start1, 0.3), with(truth, scene, start2, 0.3);
        for (int c = 0; c < 2; c++)
            insertEmpty(with.images[c], empty);
        with.rvecs.insert(with.rvecs.begin() + empty, Mat::zeros(3, 1, CV_64F));
        with.tvecs.insert(with.tvecs.begin() + empty, Mat(Vec3d(0, 0, 600), true));
        const double rms = without.run(0);
        CHECK(with.run(0) == Approx(rms).epsilon(1e-9));
        CHECK(norm(with.cameras[0]->window().normal - without.cameras[0]->window().normal) < 1e-9);
        CHECK(std::isnan(with.perViewErrors.at<double>(empty, 0)));
    }
}

TEST_CASE("What flags free of windows a camera without one does not get", "[calibrate_arguments]")
{
    CAPTURE(seed());
    Random random(3520);
    RigTruth truth = makeRig(2, { 0, 1 }, 1.);
    const RigScene scene = makeRigScene(truth, 5, random, 0.1);
    for (int flags : { (int)GLASS_FREE_CURVATURE, (int)GLASS_FREE_WEDGE })
    {
        RigCall call(truth, scene, true);
        call.cameras[1]->setWindow(GlassWindow());
        call.refracted[1].assign(scene.object.size(), Mat());
        const size_t count = call.cameras[1]->parameterNames().size();
        call.run(flags);
        CHECK(call.cameras[1]->window().shape == WINDOW_FLAT);
        CHECK(call.cameras[1]->window().wedge.empty());
        CHECK(call.cameras[1]->parameterNames().size() == count);
        CHECK(call.cameras[0]->parameterNames().size() > count + 2);
    }
}

TEST_CASE("Where the optimum touches the window, that is said, and not to iterate more", "[calibrate_arguments]")
{
    // Boards close behind a wall that is given as too thick and too far: where they fit best, they are in it.
    CAPTURE(seed());
    Random random(3530);
    int touching = 0;
    const int calibrations = trials(5);
    for (int trial = 0; trial < calibrations; trial++)
    {
        const GlassWindow wall(Vec3d(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 1), 20, 1.5, 100, 1.333);
        const Ptr<RefractiveCamera> truth = RefractiveCamera::create(Matx33d(900, 0, 640, 0, 900, 480, 0, 0, 1), noArray(), wall);
        ObjectViews object;
        std::vector<Mat> pixels, rvecs, tvecs;
        while (object.size() < 6)
        {
            const std::vector<Point3d> target = board(7, 5, 12);
            const Vec3d tvec(random.uniform(-41, -31), random.uniform(-29, -19), random.uniform(138, 150));
            std::vector<Point2d> image;
            std::vector<uchar> status;
            refractiveProjectPoints(target, random.vector(0.3), tvec, truth, image, status);
            if (countNonZero(status) > 0)
                continue;
            for (Point2d& p : image)
                p += Point2d(random.normal(0.05), random.normal(0.05));
            object.push_back(target);
            pixels.push_back(Mat(image, true));
        }
        GlassWindow given = wall;
        given.thickness[0] = random.uniform(20, 28);
        given.distance = random.uniform(100, 112);
        const auto refusal = [&](int maxCount)
        {
            const Ptr<RefractiveCamera> camera = RefractiveCamera::create(truth->cameraMatrix(), noArray(), given);
            try
            {
                calibrateGlass(object, noArray(), pixels, camera, rvecs, tvecs, 0, TermCriteria(3, maxCount, 1e-12));
            }
            catch (const CalibrationError& e)
            {
                return e;
            }
            return CalibrationError(CalibrationError::NO_POSE, "", "");
        };
        const CalibrationError e = refusal(1000);
        if (e.err.empty())
            continue;
        CAPTURE(trial, e.err);
        const bool hasNoStart = e.cause == CalibrationError::NO_POSE || e.cause == CalibrationError::NO_IMAGE;
        CHECK((hasNoStart || e.cause == CalibrationError::NOT_CONVERGED));
        if (e.cause != CalibrationError::NOT_CONVERGED)
            continue;
        touching++;
        CHECK_THAT(e.err, Contains("touches the window of camera 1") && !Contains("maxCount"));
        CHECK((e.view >= 0 && e.view < 6 && e.point >= 0 && e.point < 35 && e.camera == 0));
        CHECK_THAT(refusal(3).err, Contains("raise criteria.maxCount"));
    }
    std::cout << "[numbers] optimum that touches the window: in " << touching << " of " << calibrations << " calibrations" << std::endl;
    CHECK(touching > 0);
}

TEST_CASE("An empty rotation is none where it may not be left out", "[calibrate_arguments]")
{
    Random random(3560);
    const RigTruth truth = makeRig(2, { 0, 1 }, 1.333);
    const Ptr<RefractiveCamera> first = truth.cameras[0], second = truth.cameras[1];
    const Vec3d T = truth.Ts[1];
    const std::vector<Point2d> pixels(1, Point2d(640, 480));
    const std::vector<Point3d> points(1, Point3d(0, 0, 600));
    std::vector<Point3d> found;
    std::vector<Point2d> projected;
    Mat status;
    std::vector<Mat> lines;
    CHECK_THROWS_WITH(triangulateRefractive(first, second, Mat(), T, pixels, pixels, found), Contains("R is empty"));
    const std::vector<Mat> Rs = { Mat::eye(3, 3, CV_64F), Mat() }, Ts = { Mat::zeros(3, 1, CV_64F), Mat(T) };
    CHECK_THROWS_WITH(triangulateRefractive(truth.cameras, Rs, Ts, std::vector<std::vector<Point2d> >(2, pixels), found),
                      Contains("Rs[1] is empty"));
    CHECK_THROWS_WITH(refractiveProjectPoints(points, noArray(), T, first, projected), Contains("rvec is empty"));
    CHECK_THROWS_WITH(computeRefractiveEpilines(pixels, 1, first, second, Mat(), T, Vec2d(300, 900), lines),
                      Contains("R is empty"));
    refractiveUndistortPoints(pixels, projected, first, 600., noArray(), noArray(), status);      // may be left out
    CHECK(countNonZero(status) == 0);
}

TEST_CASE("R and Rs that are rotation vectors become those of the rig", "[calibrate_arguments]")
{
    CAPTURE(seed());
    Random random(3570);
    const RigTruth truth = makeRig(2, { 0, 1 }, 1.333);
    const RigScene scene = makeRigScene(truth, 6, random, 0.1);
    RigCall call(truth, scene, true), same(truth, scene, true);
    call.run(GLASS_FREE_EXTRINSICS);
    std::vector<Vec3d> Rs, Ts;
    for (int c = 0; c < 2; c++)
    {
        Vec3d rvec;
        Rodrigues(same.Rs[c], rvec);
        Rs.push_back(rvec);
        Ts.push_back(Vec3d(same.Ts[c]));
    }
    std::vector<Mat> rvecs, tvecs;
    Vec3d R = Rs[1];
    Mat T(Ts[1], true);
    calibrateGlassRig(same.object, same.direct, same.refracted, same.cameras, same.windows, Rs, Ts, rvecs, tvecs,
                      GLASS_FREE_EXTRINSICS, TermCriteria(3, 1000, 1e-12));
    Vec3d expected;
    Rodrigues(call.Rs[1], expected);
    CHECK(norm(Rs[1] - expected) < 1e-12);
    RigCall pair(truth, scene, true);
    stereoCalibrateGlass(pair.object, pair.direct[0], pair.refracted[0], pair.direct[1], pair.refracted[1], pair.cameras[0],
                         pair.cameras[1], R, T, rvecs, tvecs, GlassRigOptions(GLASS_FREE_EXTRINSICS));
    CHECK(norm(R - expected) < 1e-6);
    // What has no room for R leaves the cameras as they were.
    RigCall kept(truth, scene, true);
    std::vector<Vec3f> floats(2);
    const Vec3d before = kept.cameras[0]->window().normal;
    std::vector<Vec3d> places = Ts;
    for (int c = 0; c < 2; c++)
        floats[c] = Rs[c];
    CHECK_THROWS_WITH(calibrateGlassRig(kept.object, kept.direct, kept.refracted, kept.cameras, kept.windows, floats, places, rvecs,
                                        tvecs, GLASS_FREE_EXTRINSICS), Contains("Rs must be"));
    CHECK(kept.cameras[0]->window().normal == before);
}

TEST_CASE("In air the distance of a pane may be free if its faces are not parallel planes", "[calibrate_arguments]")
{
    CAPTURE(seed());
    Random random(3580);
    GlassWindow pane({ 0.2, 0.1, 1 }, 20, 1.5, 250);
    for (bool isWedge : { true, false })
    {
        GlassWindow window = pane;
        if (isWedge)
            window.wedge = { Vec2d(0.02, -0.01) };
        RigTruth truth;
        truth.windows = { 0 };
        truth.Rs = { Matx33d::eye() };
        truth.Ts = { Vec3d() };
        truth.cameras = { paperCamera(window) };
        const RigScene scene = makeRigScene(truth, 6, random, 0.05);
        RigCall call(truth, scene, true);
        CAPTURE(isWedge);
        if (!isWedge)
        {
            CHECK_THROWS_WITH(call.run(GLASS_FREE_DISTANCE), Contains("parallel planes"));
            continue;
        }
        call.run(GLASS_FREE_DISTANCE);
        const double stated = call.stdDeviations.at<double>(call.cameras[0]->lensParameters().rows + 3);
        CHECK(std::abs(call.cameras[0]->window().distance - 250) < 5*stated);
    }
}
