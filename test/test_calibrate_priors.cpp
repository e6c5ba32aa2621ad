// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// One rule for every covariance that is given: symmetric, positive semidefinite, 0 is exact, NaN is not known.
#include "bundle_scenes.hpp"
#include "target_scenes.hpp"
#include "math/covariance_matrix.hpp"
#include <functional>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

const int CAMERA = 16;                  // parameters: lens, normal, distance, thickness, index, innerIndex, outerIndex

//! A call that takes a covariance of some size, by the name it has there.
struct Taker
{
    std::string name;
    int side;
    std::function<void(const Mat&)> call;
};

//! Targets before one camera, paired; and a pair of cameras that sees a wand.
struct Scenes
{
    Scenes() : random(3400), truth(makeRig(1, { 0 }, 1.)), pair(makeRig(2, { 0, 1 }, 1.333))
    {
        scene = makeRigScene(truth, ObjectViews(5, board()), random, 0.1);
        wand = makeWandScene(pair, 20, random, 0.1);
    }

    RigCall targets() const { return RigCall(truth, scene, true); }
    BundleCall bundle() const
    {
        Random start(3401);
        return BundleCall(pair, wand, start, 0.3);
    }
    //! With known poses.
    RigCall posed(const Mat& covariance, int flags = GLASS_USE_POSES) const
    {
        RigCall call(truth, scene, false);
        call.rvecs = vectorsOf(scene.rvecs);
        call.tvecs = vectorsOf(scene.tvecs);
        call.poseCovariances.assign(scene.object.size(), covariance);
        call.run(flags);
        return call;
    }

    std::vector<Taker> takers() const
    {
        return { { "cameraCovariances[0]", CAMERA, [this](const Mat& C) { targets().run(0, { C }); } },
                 { "targetCovariance", 7, [this](const Mat& C) { targets().run(0, { Mat() }, C); } },
                 { "poseCovariances[0]", 6, [this](const Mat& C) { posed(C); } },
                 { "rigCovariance", 2*CAMERA + 6, [this](const Mat& C) { bundle().run(C, 0, GLASS_FREE_EXTRINSICS); } } };
    }

    Random random;
    const RigTruth truth, pair;
    RigScene scene;
    BundleScene wand;
};

} // namespace

TEST_CASE("What is no covariance is refused with its name and numbers, whatever it is of", "[known][prior]")
{
    const Scenes scenes;
    for (const Taker& taker : scenes.takers())
    {
        CAPTURE(taker.name);
        const auto why = [&](const std::function<void(Mat&)>& change)
        {
            Mat C = Mat::zeros(taker.side, taker.side, CV_64F);
            for (int i = 0; i < std::min(taker.side, 8); i++)       // of cameras, the lens
                C.at<double>(i, i) = 1e-6;
            change(C);
            return thrown([&] { taker.call(C); });
        };
        CHECK(why([](Mat&) {}) == "");
        CHECK_THAT(why([&](Mat& C) { C.at<double>(2, 1) = 5e-7; }),
                   Contains(taker.name + " is not symmetric: it has 0 in row 1, column 2, but 5e-07 in row 2, column 1"));
        CHECK_THAT(why([&](Mat& C) { C.at<double>(1, 2) = 5e-7; }),
                   Contains(taker.name + " is not symmetric: it has 5e-07 in row 1, column 2, but 0 in row 2, column 1"));
        CHECK_THAT(why([&](Mat& C) { C.at<double>(1, 2) = C.at<double>(2, 1) = 2e-6; }),
                   Contains(taker.name + " is not positive semidefinite: its correlations have the eigenvalue -1"));
        CHECK_THAT(why([&](Mat& C) { C.at<double>(1, 1) = -1e-6; }), Contains(taker.name + " has the variance -1e-06 in row 1"));
        CHECK_THAT(why([&](Mat& C) { C.at<double>(1, 1) = 0; C.at<double>(1, 2) = C.at<double>(2, 1) = 5e-7; }),
                   Contains(taker.name + " has a covariance that is not 0 for a quantity with variance 0: 5e-07 in row 1, column 2"));
        CHECK_THAT(why([&](Mat& C) { C.at<double>(1, 2) = NaN; }), Contains(taker.name + " has nan in row 1, column 2"));
        CHECK_THAT(why([&](Mat& C) { C.at<double>(1, 1) = INF; }), Contains(taker.name + " has inf in row 1, column 1"));
        // Printed with six digits.
        CHECK(why([&](Mat& C) { C.at<double>(1, 2) = 5e-7; C.at<double>(2, 1) = 5.000001e-7; }) == "");
    }
}

TEST_CASE("knownCovariance: symmetric, and 0 beside what is exact or not known", "[known][prior]")
{
    Mat_<double> C = (Mat_<double>(4, 4) << 4, 1, NaN, 0, 1.0000001, 9, 7, 0, 3, NaN, NaN, 5, 0, 0, -6, 0);
    const Mat_<double> known = knownCovariance(C, "C");
    CHECK(known(0, 0) == 4);
    CHECK(known(1, 1) == 9);
    CHECK(known(0, 1) == Approx(1.00000005).epsilon(1e-12));
    CHECK(known(0, 1) == known(1, 0));
    CHECK(std::isnan(known(2, 2)));
    CHECK(known(3, 3) == 0);
    for (int i : { 0, 1, 3 })
        CHECK((known(i, 2) == 0 && known(2, i) == 0));
    CHECK(knownCovariance(Mat(), "C").empty());
}

TEST_CASE("Where a covariance is singular, a combination is known", "[known][prior]")
{
    const Scenes scenes;
    CAPTURE(seed());
    // fx and fy are off alike.
    const auto lens = [&](double correlation)
    {
        RigCall call = scenes.targets();
        Mat start = call.cameras[0]->lensParameters();
        start.at<double>(0) += 2;
        start.at<double>(1) += 2;
        call.cameras[0]->setLensParameters(start);
        Mat C = Mat::zeros(CAMERA, CAMERA, CV_64F);
        C.at<double>(0, 0) = C.at<double>(1, 1) = 9;
        C.at<double>(0, 1) = C.at<double>(1, 0) = 9*correlation;
        call.run(0, { C });
        return call;
    };
    const RigCall tied = lens(1), nearly = lens(1 - 1e-8);
    const Mat K = tied.cameras[0]->cameraMatrix(), start = scenes.truth.cameras[0]->cameraMatrix();
    CHECK(K.at<double>(0, 0) - start.at<double>(0, 0) == Approx(K.at<double>(1, 1) - start.at<double>(1, 1)).margin(1e-3));
    CHECK(std::abs(K.at<double>(0, 0) - start.at<double>(0, 0)) < 5*tied.stdDeviations.at<double>(0));
    CHECK(norm(tied.cameras[0]->window().normal - nearly.cameras[0]->window().normal) < 1e-6);
    // The same of a rig.
    Mat C = Mat::zeros(2*CAMERA + 6, 2*CAMERA + 6, CV_64F);
    C(Rect(0, 0, 2, 2)).setTo(1);
    BundleCall bundle = scenes.bundle();
    bundle.run(C, 0, GLASS_FREE_EXTRINSICS);
    const Mat K1 = bundle.cameras[0]->cameraMatrix(), before = scenes.pair.cameras[0]->cameraMatrix();
    CHECK(K1.at<double>(0, 0) - before.at<double>(0, 0) == Approx(K1.at<double>(1, 1) - before.at<double>(1, 1)).margin(1e-3));
    CHECK(K1.at<double>(0, 0) != before.at<double>(0, 0));
}

TEST_CASE("A pose may be exact in a part, and not known in another", "[known][prior]")
{
    const Scenes scenes;
    CAPTURE(seed());
    const auto covariance = [](double rotation, double translation)
    {
        Mat C = Mat::zeros(6, 6, CV_64F);
        for (int i = 0; i < 6; i++)
            C.at<double>(i, i) = i < 3 ? rotation : translation;
        return C;
    };
    const auto compare = [](const RigCall& one, const RigCall& other, double relative)
    {
        CHECK(norm(one.cameras[0]->window().normal - other.cameras[0]->window().normal) < relative*one.stdDeviations.at<double>(8));
        for (int i = 8; i < 11; i++)
            CHECK(one.stdDeviations.at<double>(i) == Approx(other.stdDeviations.at<double>(i)).epsilon(relative).margin(1e-12));
    };
    compare(scenes.posed(covariance(0, 0.01)), scenes.posed(covariance(1e-15, 0.01)), 1e-4);
    compare(scenes.posed(covariance(1e-6, 0)), scenes.posed(covariance(1e-6, 1e-12)), 1e-4);
    compare(scenes.posed(covariance(0, 0)), scenes.posed(Mat()), 1e-12);
    // Not known at all: as if it had not been given. Not known in a part: no more than without the rest.
    RigCall free(scenes.truth, scenes.scene, false);
    free.run(0);
    compare(scenes.posed(covariance(NaN, NaN)), free, 1e-6);
    const RigCall part = scenes.posed(covariance(NaN, 0.01)), vague = scenes.posed(covariance(1e2, 0.01));
    for (int i = 8; i < 11; i++)
        CHECK(part.stdDeviations.at<double>(i) == Approx(vague.stdDeviations.at<double>(i)).epsilon(0.05).margin(1e-12));
    // What is given where nothing is known has no effect, be it no number. As of an IMU, which tells rotations alone.
    for (bool isPaired : { false, true })
        for (int unknown : { 0, 3 })
        {
            CAPTURE(isPaired, unknown);
            const Mat C = unknown == 0 ? covariance(NaN, 0.01) : covariance(1e-8, NaN);
            const auto posed = [&](const Vec3d* value)
            {
                RigCall call(scenes.truth, scenes.scene, isPaired);
                call.rvecs = vectorsOf(scenes.scene.rvecs);
                call.tvecs = vectorsOf(scenes.scene.tvecs);
                call.poseCovariances.assign(scenes.scene.object.size(), C);
                for (Mat& vector : unknown == 0 ? call.rvecs : call.tvecs)
                    vector = value ? Mat(*value, true) : vector;
                call.run(GLASS_USE_POSES);
                return call;
            };
            const Vec3d elsewhere = unknown == 0 ? Vec3d(2, 1, -2) : Vec3d(100, -300, -50), nan = Vec3d::all(NaN);
            const RigCall given = posed(nullptr);
            compare(posed(&elsewhere), given, 1e-4);
            compare(posed(&nan), given, 1e-4);
        }
}

TEST_CASE("Poses that a calibration returns are taken by the next one", "[known][prior][bundle]")
{
    CAPTURE(seed());
    const Scenes scenes;
    RigCall first(scenes.truth, scenes.scene, false);
    first.object.insert(first.object.begin(), board());
    first.refracted[0].insert(first.refracted[0].begin(), Mat());
    first.run(0);
    REQUIRE(std::isnan(first.tvecs[0].at<double>(0)));
    RigCall second = first;
    second.poseCovariances.assign(second.object.size(), Mat::eye(6, 6, CV_64F)*1e-8);
    CHECK(second.run(GLASS_USE_POSES) > 0);
    CHECK(std::isnan(second.tvecs[0].at<double>(0)));
    second.rvecs[1].at<double>(2) = NaN;        // of a view that has an image
    CHECK_THROWS_WITH(second.run(GLASS_USE_POSES), Contains("rvecs[1][2] is nan; it must be finite"));

    Random random(3410), start(3411);
    const BundleScene scene = makeMovingScene(scenes.pair, 4, 40, random, 0.1);
    BundleCall bundle(scenes.pair, scene, start, 0.3);
    for (std::vector<Mat>& images : bundle.images)
        images[2] = Mat();
    const double rms = bundle.run(0);
    REQUIRE(std::isnan(bundle.tvecs[2].at<double>(0)));
    CHECK(bundle.run(0) == Approx(rms).epsilon(1e-6));
}

TEST_CASE("NaN says that nothing is known, of cameras, targets, the rig and lengths", "[known][prior]")
{
    const Scenes scenes;
    CAPTURE(seed());
    RigCall none = scenes.targets(), nan = scenes.targets();
    none.run(GLASS_FREE_THICKNESS, { Mat() });
    nan.run(GLASS_FREE_THICKNESS, { Mat(CAMERA, CAMERA, CV_64F, Scalar(NaN)) });
    CHECK(largestDifference(none.stdDeviations, nan.stdDeviations) == 0);
    // A motion of the targets of which nothing is known: as a prior that is far too wide.
    Mat unknown = Mat::zeros(7, 7, CV_64F), wide = unknown.clone();
    for (int i = 1; i < 7; i++)
    {
        unknown.at<double>(i, i) = NaN;
        wide.at<double>(i, i) = i < 4 ? 1e2 : 1e8;
    }
    RigCall free = scenes.targets(), within = scenes.targets();
    free.run(0, { Mat() }, unknown);
    within.run(0, { Mat() }, wide);
    REQUIRE(free.stdDeviations.rows == within.stdDeviations.rows);
    for (int i = 8; i < 11; i++)
        CHECK(free.stdDeviations.at<double>(i) == Approx(within.stdDeviations.at<double>(i)).epsilon(0.05).margin(1e-12));
    // Of a rig the flags decide.
    Mat C = Mat::zeros(2*CAMERA + 6, 2*CAMERA + 6, CV_64F), some = C.clone();
    C.at<double>(0, 0) = some.at<double>(0, 0) = 1;
    for (int i = 0; i < C.rows; i++)
        some.at<double>(5, i) = some.at<double>(i, 5) = NaN;
    BundleCall zero = scenes.bundle(), other = scenes.bundle();
    zero.run(C, 0, GLASS_FREE_EXTRINSICS);
    other.run(some, 0, GLASS_FREE_EXTRINSICS);
    CHECK(largestDifference(zero.stdDeviations, other.stdDeviations) == 0);
    // Of a length: as if it were not there.
    BundleCall fewer = scenes.bundle(), marked = scenes.bundle();
    fewer.lengths.erase(fewer.lengths.begin() + 3);
    marked.lengths[3][3] = NaN;
    fewer.run(GLASS_FREE_EXTRINSICS);
    marked.run(GLASS_FREE_EXTRINSICS);
    CHECK(largestDifference(fewer.stdDeviations, marked.stdDeviations) == 0);
}

TEST_CASE("A covariance of R and T tells the scale, with any flags; without it there is a CalibrationError", "[known][prior][bundle]")
{
    const Scenes scenes;
    CAPTURE(seed());
    const int P = 2*CAMERA + 6;
    Mat ofRig = Mat::zeros(P, P, CV_64F), ofCamera = Mat::zeros(CAMERA + 6, CAMERA + 6, CV_64F);
    for (int i = 0; i < 6; i++)
        ofRig.at<double>(2*CAMERA + i, 2*CAMERA + i) = ofCamera.at<double>(CAMERA + i, CAMERA + i) = i < 3 ? 1e-6 : 0.04;
    const auto run = [&](int flags, const Mat& rig, const std::vector<Mat>& cameras, double lengthScaleStd = 0, bool hasLengths = false)
    {
        BundleCall call = scenes.bundle();
        if (!hasLengths)
            call.lengths.clear();
        BundleAdjustOptions options(flags);
        options.cameraCovariances = cameras;
        options.rigCovariance = rig;
        options.lengthScaleStd = lengthScaleStd;
        call.run(options);
        return call;
    };
    const int FREE = GLASS_FIX_NORMAL | GLASS_FREE_EXTRINSICS;
    for (const BundleCall& call : { run(FREE, ofRig, {}), run(FREE, Mat(), { Mat(), ofCamera }) })
    {
        const BundleCall same = run(GLASS_FIX_NORMAL, ofRig, {});
        CHECK(largestDifference(call.Ts[1], same.Ts[1]) < 1e-6);
        CHECK(call.stdDeviations.at<double>(P - 3) == Approx(same.stdDeviations.at<double>(P - 3)).epsilon(1e-6));
    }
    // T exact, in a covariance; lengths whose common error is not known, beside it.
    const Mat exact = Mat::zeros(CAMERA + 6, CAMERA + 6, CV_64F);
    CHECK(run(FREE, Mat(), { Mat(), exact }).stdDeviations.at<double>(P - 3) == 0);
    CHECK_NOTHROW(run(FREE, ofRig, {}, NaN, true));
    const auto cause = [&](const std::function<void()>& call)
    {
        try { call(); }
        catch (const CalibrationError& e) { return (int)e.cause; }
        return -1;
    };
    CHECK(cause([&] { run(FREE, Mat(), {}); }) == CalibrationError::NO_SCALE);
    CHECK(cause([&] { run(FREE, Mat(), {}, NaN, true); }) == CalibrationError::NO_SCALE);
    const Mat unknown(CAMERA + 6, CAMERA + 6, CV_64F, Scalar(NaN));
    CHECK(cause([&] { run(FREE, Mat(), { Mat(), unknown }); }) == CalibrationError::NO_SCALE);

    // Poses tell it where their translations are known; rotations do not.
    const auto posed = [&](double translation)
    {
        Random random(3402), start(3403);
        const BundleScene moving = makeMovingScene(scenes.pair, 4, 40, random, 0.1);
        BundleCall call(scenes.pair, moving, start, 0);
        Mat C = Mat::zeros(6, 6, CV_64F);
        for (int i = 0; i < 6; i++)
            C.at<double>(i, i) = i < 3 ? 1e-6 : translation;
        call.lengths.clear();
        call.poseCovariances.assign(4, C);
        call.run(FREE | GLASS_USE_POSES);
    };
    CHECK(cause([&] { posed(0.01); }) == -1);
    CHECK(cause([&] { posed(NaN); }) == CalibrationError::NO_SCALE);
}

TEST_CASE("A prior is about the value that was given, wherever the search begins", "[known][prior]")
{
    CAPTURE(seed());
    for (int trial = 0; trial < 4; trial++)
    {
        CAPTURE(trial);
        Random random(3440 + trial);
        const RigTruth truth = makeRig(1, { 0 }, 1.333);
        const RigScene scene = makeRigScene(truth, ObjectViews(4, board()), random, 1.);
        RigCall with(truth, scene, false), without(truth, scene, false);
        const double distance = truth.cameras[0]->window().distance;
        for (RigCall* call : { &with, &without })
        {
            GlassWindow window = call->cameras[0]->window();
            window.distance = distance;
            call->cameras[0]->setWindow(window);
        }
        Mat prior(CAMERA, CAMERA, CV_64F, Scalar(0));
        prior.at<double>(11, 11) = 0.25;            // of the distance, mm^2
        for (int i = 0; i < 4; i++)
            prior.at<double>(i, i) = 0.01;          // of the lens, px^2
        for (int flags : { (int)GLASS_FREE_DISTANCE, GLASS_FREE_DISTANCE | GLASS_FREE_INTRINSICS | GLASS_FIX_TANGENT_DIST | GLASS_FIX_K1 |
                                                         GLASS_FIX_K2 })
        {
            CAPTURE(flags);
            RigCall call = with;
            call.cameras[0] = with.cameras[0]->clone();
            call.run(flags, { prior });
            const double sigma = call.stdDeviations.at<double>(11);
            CAPTURE(call.cameras[0]->window().distance, sigma);
            CHECK(std::abs(call.cameras[0]->window().distance - distance) < 4*sigma);
            CHECK((sigma > 0 && sigma < 0.55));
        }
        without.run(GLASS_FREE_DISTANCE);
        CHECK(without.stdDeviations.at<double>(11) > 2);           // what the images alone tell
    }
}
