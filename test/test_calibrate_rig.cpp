// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// calibrateGlassRig: any number of cameras, shared windows, known poses.
#include "bundle_scenes.hpp"
#include "rig_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

TEST_CASE("Four cameras behind three windows, R and T free, from perfect data", "[rig_glass]")
{
    Random random(600);
    CAPTURE(seed());
    const RigTruth truth = makeRig(4, { 0, 7, 0, 2 }, 1.333);
    for (bool paired : { true, false })
    {
        const RigScene scene = makeRigScene(truth, 8, random, 0);
        RigCall call(truth, scene, paired);
        for (int c = 1; c < 4; c++)
            call.Ts[c] += Mat(Vec3d(2, -1, 1));
        CHECK(call.run(GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE) < 1e-5);
        for (int c = 0; c < 4; c++)
        {
            CAPTURE(paired, c);
            CHECK(angleBetween(call.cameras[c]->window().normal, truth.cameras[c]->window().normal) < 1e-3);
            CHECK(call.cameras[c]->window().distance == Approx(truth.cameras[c]->window().distance).epsilon(1e-4));
            CHECK(norm(call.Ts[c], Mat(truth.Ts[c])) < 1e-2);
        }
        // Cameras 1 and 3 look through one window.
        const Matx33d R(call.Rs[2]);
        CHECK(norm(R*call.cameras[0]->window().normal - call.cameras[2]->window().normal) < 1e-12);
        CHECK(call.imageStatus.size() == Size(8, 8));
        CHECK(call.imageStatus.at<uchar>(0, 0) == (paired ? GLASS_IMAGE_USED : GLASS_IMAGE_ABSENT));
        CHECK(call.perViewErrors.size() == Size(8, 8));
        REQUIRE(call.inliers.size() == 64);
        CHECK(countNonZero(call.inliers[1]) == 30);
    }
}

TEST_CASE("A window shared by cameras other than the first, whose owner moves", "[rig_glass]")
{
    Random random(610);
    CAPTURE(seed());
    const RigTruth truth = makeRig(3, { 0, 1, 1 }, 1.333);
    RigCall call(truth, makeRigScene(truth, 8, random, 0), true);
    call.Ts[1] += Mat(Vec3d(1, 1, -1));
    call.Ts[2] += Mat(Vec3d(-1, 2, 1));
    CHECK(call.run(GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE) < 1e-5);
    CHECK(angleBetween(call.cameras[2]->window().normal, truth.cameras[2]->window().normal) < 1e-3);
    CHECK(norm(call.Ts[2], Mat(truth.Ts[2])) < 1e-2);
}

TEST_CASE("The covariance of three cameras covers their errors", "[rig_glass]")
{
    const int runs = 60;
    double mahalanobis = 0;
    const RigTruth truth = makeRig(3, { 0, 1, 1 }, 1.333);
    for (int run = 0; run < runs; run++)
    {
        Random random(6200 + run);
        RigCall call(truth, makeRigScene(truth, 3, random, 0.1), true);
        call.run(GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE);
        // three cameras of 16 parameters, then R, T of the second and third
        REQUIRE(call.covariance.size() == Size(60, 60));
        const int normal3 = 32 + 8, T3 = 57;
        std::vector<int> rows = { normal3, normal3 + 1, normal3 + 2, normal3 + 3, T3, T3 + 1, T3 + 2 };
        const GlassWindow found = call.cameras[2]->window(), right = truth.cameras[2]->window();
        const Vec3d n = found.normal - right.normal, T = Vec3d(call.Ts[2]) - truth.Ts[2];
        mahalanobis += squaredMahalanobis({ n[0], n[1], n[2], found.distance - right.distance, T[0], T[1], T[2] },
                                          call.covariance, rows)/runs;
    }
    CAPTURE(mahalanobis, seed());
    CHECK(mahalanobis == Approx(6).epsilon(0.25));      // chi^2: normal 2, distance 1, T 3
}

TEST_CASE("One camera: the rig is calibrateGlass; the stereo pair is stereoCalibrateGlass", "[rig_glass]")
{
    Random random(630);
    CAPTURE(seed());
    const RigTruth truth = makeRig(2, { 0, 1 }, 1);
    const RigScene scene = makeRigScene(truth, 4, random, 0.1);
    RigCall rig(truth, scene, true);
    const double rms = rig.run(GLASS_FREE_THICKNESS | GLASS_FREE_EXTRINSICS);
    RigCall start(truth, scene, true);
    Mat R = start.Rs[1], T = start.Ts[1];
    const GlassRigResult pair = stereoCalibrateGlass(scene.object, scene.direct[0], scene.refracted[0], scene.direct[1],
                                                     scene.refracted[1], start.cameras[0], start.cameras[1], R, T, noArray(),
                                                     noArray(), GlassRigOptions(GLASS_FREE_THICKNESS | GLASS_FREE_EXTRINSICS));
    CHECK(pair.rms == rms);
    CHECK(norm(T, rig.Ts[1]) == 0);
    CHECK(norm(pair.covariance, rig.covariance) == 0);
    CHECK(norm(pair.perViewErrors, rig.perViewErrors) == 0);
    CHECK(pair.pixelStd == rig.pixelStd);

    RigTruth one = truth;
    RigScene seenByOne = scene;
    keepFirst(one, seenByOne);
    RigCall single(one, seenByOne, true), again(one, seenByOne, true);
    const double alone = single.run(GLASS_FREE_THICKNESS);
    CHECK(calibrateGlass(scene.object, scene.direct[0], scene.refracted[0], again.cameras[0], noArray(), noArray(),
                         GLASS_FREE_THICKNESS) == alone);
    CHECK(again.cameras[0]->window().normal == single.cameras[0]->window().normal);
}

TEST_CASE("stereoCalibrateGlass takes what is known of cameras, targets and pixels, as the rig does", "[rig_glass]")
{
    Random random(631);
    CAPTURE(seed());
    const RigTruth truth = makeRig(2, { 0, 1 }, 1);
    const RigScene scene = makeRigScene(truth, 4, random, 0.1);
    GlassRigOptions options;
    options.criteria.maxCount = 300;
    for (int c = 0; c < 2; c++)
    {
        const int count = (int)truth.cameras[c]->parameterNames().size(), lens = (int)truth.cameras[c]->lensParameters().total();
        const int own = c == 0 ? count : count + 6;         // R and T of the second, too
        options.cameraCovariances.push_back(Mat::zeros(own, own, CV_64F));
        for (int i : { 0, 1, lens + 4 })                    // focal lengths, thickness
            options.cameraCovariances[c].at<double>(i, i) = i < 2 ? 1 : 0.01;
        for (int i = count; i < own; i++)
            options.cameraCovariances[c].at<double>(i, i) = i < count + 3 ? 1e-6 : 0.01;
        options.pixelCovariancesRefracted.push_back(std::vector<Mat>(4, Mat(30, 1, CV_64FC3, Scalar(1, 0.2, 2))));
    }
    options.targetCovariance = Mat::diag(Mat(std::vector<double>{ 1e-6, 1e-6, 1e-6, 1e-6, 0.01, 0.01, 0.01 }));
    RigCall rig(truth, scene, true), start(truth, scene, true);
    rig.run(options);
    Mat R = start.Rs[1], T = start.Ts[1];
    const GlassRigResult pair = stereoCalibrateGlass(scene.object, scene.direct[0], scene.refracted[0], scene.direct[1],
                                                     scene.refracted[1], start.cameras[0], start.cameras[1], R, T, noArray(),
                                                     noArray(), options);
    CHECK(pair.rms == rig.rms);
    CHECK(norm(T, rig.Ts[1]) == 0);
    CHECK(norm(T, truth.Ts[1]) > 0);
    CHECK(norm(pair.covariance, rig.covariance) == 0);
    CHECK(norm(pair.targetErrors, rig.targetErrors) == 0);
    CHECK(pair.degreesOfFreedom == rig.degreesOfFreedom);
    options.computeCovariance = false;
    RigCall quick(truth, scene, true);
    CHECK(quick.run(options) == Approx(rig.rms).epsilon(1e-6));
    CHECK(quick.covariance.empty());
    CHECK(quick.stdDeviations.empty());
}

TEST_CASE("The noise that a result tells is that of a usual pixel, whatever all pixels are", "[rig_glass][bundle]")
{
    Random random(632);
    CAPTURE(seed());
    const RigTruth truth = makeRig(2, { 0, 1 }, 1.333);
    const RigScene scene = makeRigScene(truth, 4, random, 0.1);
    const BundleScene points = makeMovingScene(truth, 4, 40, random, 0.1);
    GlassRigOptions options(GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE);
    BundleAdjustOptions ofBundle(GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE);
    RigCall usual(truth, scene, true), noisy(truth, scene, true);
    Random start(633), again(633);
    BundleCall usualBundle(truth, points, start), noisyBundle(truth, points, again);
    usual.run(options);
    usualBundle.run(ofBundle);
    const Mat four(30, 1, CV_64FC3, Scalar(4, 0, 4)), ofPoints(40, 1, CV_64FC3, Scalar(4, 0, 4));
    options.pixelCovariancesDirect.assign(2, std::vector<Mat>(4, four));
    options.pixelCovariancesRefracted = options.pixelCovariancesDirect;
    ofBundle.pixelCovariances.assign(2, std::vector<Mat>(4, ofPoints));
    noisy.run(options);
    noisyBundle.run(ofBundle);
    CHECK(usual.pixelStd == Approx(0.1).epsilon(0.1));
    CHECK(usualBundle.pixelStd == Approx(0.1).epsilon(0.1));
    CHECK(noisy.pixelStd == Approx(usual.pixelStd/2).epsilon(1e-9));
    CHECK(noisyBundle.pixelStd == Approx(usualBundle.pixelStd/2).epsilon(1e-9));
    CHECK(norm(noisy.covariance, usual.covariance) < 1e-9*norm(usual.covariance));
    CHECK(norm(noisyBundle.covariance, usualBundle.covariance) < 1e-9*norm(usualBundle.covariance));
}

TEST_CASE("Known poses: one view through the window determines its normal", "[rig_glass]")
{
    Random random(640);
    CAPTURE(seed());
    RigTruth truth = makeRig(1, { 0 }, 1);
    const RigScene scene = makeRigScene(truth, 1, random, 0.1);
    RigCall call(truth, scene, false);
    call.rvecs = vectorsOf(scene.rvecs);
    call.tvecs = vectorsOf(scene.tvecs);
    const double rms = call.run(GLASS_USE_POSES);
    CHECK(rms == Approx(0.1*std::sqrt(2.)).epsilon(0.3));
    CHECK(norm(call.tvecs[0], Mat(scene.tvecs[0])) == 0);
    const double error = angleBetween(call.cameras[0]->window().normal, truth.cameras[0]->window().normal);
    const double sigma = std::sqrt(trace(call.covariance(Rect(8, 8, 3, 3)))[0])*180/CV_PI;
    CHECK(sigma < 0.06);
    CHECK(error < 4*sigma);
}

TEST_CASE("Poses known with a covariance: between none and exact, and as good as stated", "[rig_glass][slow]")
{
    const int runs = 100;
    double mahalanobis = 0, exact = 0, uncertain = 0, unknown = 0;
    const RigTruth truth = makeRig(1, { 0 }, 1);
    for (int run = 0; run < runs; run++)
    {
        Random random(6500 + run);
        const RigScene scene = makeRigScene(truth, 4, random, 0.1);
        Mat covariance = Mat::zeros(6, 6, CV_64F);
        const double sigmaR = 1e-4, sigmaT = 0.03;
        RigCall call(truth, scene, false), best(truth, scene, false), none(truth, scene, false);
        best.rvecs = vectorsOf(scene.rvecs);
        best.tvecs = vectorsOf(scene.tvecs);
        for (int i = 0; i < 6; i++)
            covariance.at<double>(i, i) = std::pow(i < 3 ? sigmaR : sigmaT, 2);
        for (int view = 0; view < 4; view++)
        {
            const auto noise = [&](double s) { return Vec3d(random.normal(s), random.normal(s), random.normal(s)); };
            call.rvecs.push_back(Mat(scene.rvecs[view] + noise(sigmaR)));
            call.tvecs.push_back(Mat(scene.tvecs[view] + noise(sigmaT)));
            call.poseCovariances.push_back(covariance);
        }
        const Vec3d normal = truth.cameras[0]->window().normal;
        const auto square = [&](const RigCall& c) { return std::pow(angleBetween(c.cameras[0]->window().normal, normal), 2); };
        call.run(GLASS_USE_POSES);
        best.run(GLASS_USE_POSES);
        none.run(0);
        uncertain += square(call);
        exact += square(best);
        unknown += square(none);
        const Vec3d n = call.cameras[0]->window().normal - normal;
        mahalanobis += squaredMahalanobis({ n[0], n[1], n[2] }, call.covariance, { 8, 9, 10 })/runs;
    }
    CAPTURE(mahalanobis, std::sqrt(exact/runs), std::sqrt(uncertain/runs), std::sqrt(unknown/runs), seed());
    CHECK(mahalanobis == Approx(2).epsilon(0.35));
    CHECK(exact < uncertain);
    CHECK(uncertain < 0.2*unknown);
}

TEST_CASE("A second minimum of a window seen through only is told, with how much worse it is", "[rig_glass]")
{
    int withSecond = 0, ambiguous = 0;
    for (int run = 0; run < 20; run++)
    {
        Random random(3700 + run);
        CAPTURE(run, seed());
        RigTruth truth = makeRig(1, { 0 }, 1);
        truth.cameras[0]->setWindow(makeWindow(PANE_IN_AIR, random));
        const RigScene scene = makeRigScene(truth, 1, random, 0.1);
        RigCall call(truth, scene, false), paired(truth, scene, true);
        call.run(0);
        paired.run(0);
        REQUIRE(call.otherMinima.size() == Size(5, 1));
        CHECK(std::isnan(paired.otherMinima.at<double>(3)));
        const double excess = call.otherMinima.at<double>(3);
        const Vec3d other(call.otherMinima.ptr<double>()), found = call.cameras[0]->window().normal;
        const Vec3d right = truth.cameras[0]->window().normal;
        if (std::isnan(excess))
            continue;
        withSecond++;
        ambiguous += excess < 3;
        CHECK(excess >= 0);
        CHECK(angleBetween(other, found) > 0.5);
        // Where the second is out of the question the first is the right one.
        if (excess > 3)
            CHECK(angleBetween(found, right) < angleBetween(other, right));
    }
    CHECK(withSecond > 3);
    CHECK(ambiguous > 0);
}

TEST_CASE("A second minimum of a shared window is told in the frame of its first camera", "[rig_glass][slow]")
{
    int found = 0;
    for (int run = 0; run < 20; run++)
    {
        Random random(3700 + run);
        CAPTURE(run, seed());
        const RigTruth truth = makeRig(2, { 0, 0 }, 1);
        RigScene scene = makeRigScene(truth, 1, random, 0.1);
        scene.refracted[0][0][0] = Point2d(NaN, NaN);       // so that camera 2 sees more of the window, and is searched
        RigCall call(truth, scene, false);
        call.run(0);

        // Camera 2 alone, from the same start.
        const RigTruth second = { { truth.cameras[1] }, { 0 }, { Matx33d::eye() }, { Vec3d() } };
        RigScene ofSecond = scene;
        ofSecond.refracted.erase(ofSecond.refracted.begin());
        RigCall alone(second, ofSecond, false);
        GlassWindow start = call.cameras[1]->window();
        start.normal = truth.Rs[1]*Vec3d(0, 0, 1);
        alone.cameras[0]->setWindow(start);
        alone.run(0);
        const double excess = call.otherMinima.at<double>(0, 3);
        CHECK(std::isnan(call.otherMinima.at<double>(1, 3)));
        if (std::isnan(excess))
            continue;
        found++;
        CHECK(excess == Approx(alone.otherMinima.at<double>(0, 3)).epsilon(0.01));
        CHECK(angleBetween(Vec3d(call.otherMinima.ptr<double>(0)),
                           truth.Rs[1].t()*Vec3d(alone.otherMinima.ptr<double>(0))) < 0.01);
    }
    CHECK(found > 2);
}

TEST_CASE("A sealed camera: lens and normal from views through the window alone", "[rig_glass]")
{
    for (double outerIndex : { 1., 1.333 })
    {
        Random random(670);
        CAPTURE(outerIndex, seed());
        const RigTruth truth = makeRig(1, { 0 }, outerIndex);
        RigCall call(truth, makeRigScene(truth, ObjectViews(25, board()), random, 0.1, 520, 720), false);
        call.cameras[0]->setLensParameters(std::vector<double>{ 2430, 2430, 640, 505, -0.4, 0.4, 0, 0 });
        if (outerIndex != 1)
            call.cameras[0]->setWindow(GlassWindow({ 0, 0, 1 }, 20, 1.5437, 80, outerIndex));
        CHECK(call.run(GLASS_FREE_INTRINSICS | GLASS_FIX_TANGENT_DIST) == Approx(0.1*std::sqrt(2.)).epsilon(0.1));
        const Vec3d n = call.cameras[0]->window().normal - truth.cameras[0]->window().normal;
        std::vector<double> errors;
        std::vector<int> rows;
        const Mat lens = call.cameras[0]->lensParameters() - truth.cameras[0]->lensParameters();
        for (int i : { 0, 1, 2, 3, 4, 5 })
        {
            rows.push_back(i);
            errors.push_back(lens.at<double>(i));
        }
        for (int i = 0; i < 3; i++)
        {
            rows.push_back(8 + i);
            errors.push_back(n[i]);
        }
        CHECK(squaredMahalanobis(errors, call.covariance, rows) < 26);      // chi^2 of 8: 1 in 1000
    }
}

TEST_CASE("The same input gives the same bytes", "[rig_glass]")
{
    Random random(680);
    const RigTruth truth = makeRig(3, { 0, 1, 1 }, 1.333);
    RigScene scene = makeRigScene(truth, 6, random, 0.1);
    displace(scene.refracted[1], 0.2, random);
    RigCall first(truth, scene, true);
    const std::vector<std::vector<double> > elsewhere(1000, std::vector<double>(random.below(500)));     // in memory
    RigCall second(truth, scene, true);
    const int flags = GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE | GLASS_ROBUST;
    CHECK(first.run(flags) == second.run(flags));
    CHECK(largestDifference(first.covariance, second.covariance) == 0);
    CHECK(largestDifference(first.Ts[2], second.Ts[2]) == 0);
    CHECK(largestDifference(first.tvecs[5], second.tvecs[5]) == 0);
}

TEST_CASE("Only the glass was replaced: one pair, everything but the normal known", "[rig_glass]")
{
    Random random(690);
    CAPTURE(seed());
    const RigTruth truth = makeRig(1, { 0 }, 1);
    const RigScene scene = makeRigScene(truth, 1, random, 0.1);
    for (int known : { 0, (int)GLASS_USE_POSES })
    {
        RigCall call(truth, scene, true);
        call.rvecs = vectorsOf(scene.rvecs);
        call.tvecs = vectorsOf(scene.tvecs);
        call.run(known);
        const Vec3d right = truth.cameras[0]->window().normal;
        const double sigma = std::sqrt(trace(call.covariance(Rect(8, 8, 3, 3)))[0])*180/CV_PI;
        CHECK(sigma < 0.08);
        CHECK(angleBetween(call.cameras[0]->window().normal, right) < 3.5*sigma);
    }
}

TEST_CASE("calibrateGlassRig refuses", "[rig_glass]")
{
    Random random(660);
    const RigTruth truth = makeRig(2, { 0, 1 }, 1);
    const RigScene scene = makeRigScene(truth, 3, random, 0.1);
    const auto why = [&](int flags, const std::function<void(RigCall&)>& spoil)
    {
        RigCall call(truth, scene, true);
        spoil(call);
        return thrown([&] { call.run(flags); });
    };
    using Catch::Contains;
    CHECK_THAT(why(GLASS_SHARED_WINDOW, [](RigCall&) {}), Contains("flags is 64"));
    CHECK_THAT(why(GLASS_FREE_DISTANCE, [](RigCall&) {}), Contains("GLASS_FREE_DISTANCE"));
    CHECK_THAT(why(0, [](RigCall& c) { c.poseCovariances.resize(3); }), Contains("poseCovariances is given, but flags has no"));
    CHECK_THAT(why(0, [](RigCall& c) { c.cameras.clear(); }), Contains("cameras is empty"));
    CHECK_THAT(why(0, [](RigCall& c) { c.windows.pop_back(); }), Contains("windowOfCamera has 1 elements; there are 2 cameras"));
    CHECK_THAT(why(0, [](RigCall& c) { c.refracted.pop_back(); }), Contains("imagePointsRefracted has 1"));
    CHECK_THAT(why(0, [](RigCall& c) { c.refracted[1].clear(); }), Contains("imagePointsRefracted[1] has no point"));
    CHECK_THAT(why(0, [](RigCall& c) { c.direct[1].pop_back(); }), Contains("imagePointsDirect[1] has 2 views"));
    CHECK_THAT(why(0, [](RigCall& c) { c.cameras[1] = c.cameras[0]; }), Contains("one object"));
    CHECK_THAT(why(0, [](RigCall& c) { c.cameras[1].release(); }), Contains("cameras[1] is empty"));
    CHECK_THAT(why(0, [](RigCall& c) { c.Rs.pop_back(); }), Contains("Rs has 1 elements"));
    CHECK_THAT(why(0, [](RigCall& c) { c.Ts[0] = Mat(Vec3d(1, 0, 0)); }), Contains("Rs[0] and Ts[0]"));
    CHECK_THAT(why(GLASS_USE_POSES, [](RigCall&) {}), Contains("rvecs has 0 vectors"));
    const auto givePoses = [&](RigCall& c)
    {
        c.rvecs = vectorsOf(scene.rvecs);
        c.tvecs = vectorsOf(scene.tvecs);
    };
    CHECK_THAT(why(GLASS_USE_POSES, [&](RigCall& c) { givePoses(c); c.tvecs[1].at<double>(0) = NaN; }),
               Contains("tvecs[1][0] is nan"));
    CHECK_THAT(why(GLASS_USE_POSES, [&](RigCall& c) { givePoses(c); c.poseCovariances.assign(2, Mat::eye(6, 6, CV_64F)); }),
               Contains("poseCovariances has 2 elements"));
    CHECK_THAT(why(GLASS_USE_POSES, [&](RigCall& c) { givePoses(c); c.poseCovariances.assign(3, Mat::eye(5, 5, CV_64F)); }),
               Contains("poseCovariances[0] has 25 values"));
    CHECK_THAT(why(GLASS_USE_POSES, [&](RigCall& c) { givePoses(c); c.poseCovariances.assign(3, -Mat::eye(6, 6, CV_64F)); }),
               Contains("poseCovariances[0] has the variance -1 in row 0"));
}
