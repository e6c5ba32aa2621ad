// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "bundle_scenes.hpp"
#include "problem_scenes.hpp"
#include <opencv2/core/eigen.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const double WATER = 1.333;

//! A pair, 34 degrees apart, behind windows of their own.
RigTruth wandRig(int cameras = 3, double outerIndex = WATER)
{
    std::vector<int> windows;
    for (int c = 0; c < cameras; c++)
        windows.push_back(c);
    return makeRig(cameras, windows, outerIndex, 0.25);
}

RigTruth oneCamera(double outerIndex = WATER) { return makeRig(1, { 0 }, outerIndex); }

double normalError(const BundleCall& call, const RigTruth& truth, int c)
{
    return angleBetween(call.cameras[c]->window().normal, truth.cameras[c]->window().normal);
}

double largestPointError(const BundleCall& call, const BundleScene& scene)
{
    double largest = 0;
    for (size_t i = 0; i < scene.points.size(); i++)
        largest = std::max(largest, norm(call.points[i] - scene.points[i]));
    return largest;
}

} // namespace

TEST_CASE("A wand of known length is all that a standing rig needs", "[bundle]")
{
    CAPTURE(seed());
    Random random(1);
    const RigTruth truth = wandRig();
    const BundleScene scene = makeWandScene(truth, 60, random, 0);
    BundleCall call(truth, scene, random, 1, 0.9);
    CHECK(call.run(GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE) < 1e-6);
    for (int c = 0; c < 3; c++)
    {
        CHECK(normalError(call, truth, c) < 1e-5);
        CHECK(call.cameras[c]->window().distance == Approx(truth.cameras[c]->window().distance).epsilon(1e-6));
        CHECK(largestDifference(call.Rs[c], Mat(truth.Rs[c])) < 1e-7);
        CHECK(largestDifference(call.Ts[c], Mat(truth.Ts[c])) < 1e-4);
    }
    CHECK(largestPointError(call, scene) < 1e-4);
    const int P = 3*(8 + 8) + 12;
    CHECK(call.stdDeviations.size() == Size(1, P));
    CHECK(call.covariance.size() == Size(P, P));
    CHECK(call.pointDeviations.size() == Size(3, 120));
    CHECK(call.perViewErrors.size() == Size(3, 1));
    CHECK(call.inliers.size() == 3);
    CHECK(countNonZero(call.inliers[1]) == countSeen(scene.pixels[1][0]));
}

TEST_CASE("The short form of a standing rig gives what the long one does", "[bundle]")
{
    Random random(2);
    const RigTruth truth = wandRig();
    const BundleScene scene = makeWandScene(truth, 40, random, 0.1);
    BundleCall call(truth, scene, random);
    BundleCall same = call;
    for (Ptr<RefractiveCamera>& camera : same.cameras)
        camera = camera->clone();
    for (std::vector<Mat>* mats : { &same.Rs, &same.Ts })
        for (Mat& mat : *mats)
            mat = mat.clone();
    const double rms = call.run(GLASS_FREE_EXTRINSICS);
    std::vector<Mat> pixels;
    for (const std::vector<Mat>& views : same.images)
    {
        Mat floats;     // other types and layouts are the same numbers
        views[0].reshape(1).convertTo(floats, CV_64F);
        pixels.push_back(floats);
    }
    std::vector<Point3f> points;
    CHECK(refractiveBundleAdjust(pixels, same.cameras, same.windows, same.Rs, same.Ts, points, same.lengths,
                                 GLASS_FREE_EXTRINSICS) == rms);
    CHECK(largestDifference(same.Ts[2], call.Ts[2]) == 0);
    CHECK(points.size() == 80);
    CHECK(norm(Point3d(points[7]) - call.points[7]) < 1e-3);
}

TEST_CASE("One camera moves through a scene in which one distance is known", "[bundle]")
{
    CAPTURE(seed());
    Random random(3);
    const RigTruth truth = oneCamera();
    const BundleScene scene = makeMovingScene(truth, 8, 60, random, 0, 0.2);
    BundleCall call(truth, scene, random, 1, 0.9);
    CHECK(call.run(GLASS_FREE_DISTANCE) < 1e-6);
    CHECK(normalError(call, truth, 0) < 1e-5);
    CHECK(largestPointError(call, scene) < 1e-3);
    for (size_t view = 0; view < scene.tvecs.size(); view++)
        CHECK(largestDifference(call.tvecs[view], Mat(scene.tvecs[view])) < 1e-3);
    CHECK(call.perViewErrors.size() == Size(1, 8));
}

TEST_CASE("A moving pair behind one wall", "[bundle]")
{
    CAPTURE(seed());
    Random random(4);
    const RigTruth truth = makeRig(2, { 0, 0 }, WATER, 0.2);
    const BundleScene scene = makeMovingScene(truth, 5, 40, random, 0);
    BundleCall call(truth, scene, random, 0.5);
    CHECK(call.run(GLASS_FREE_EXTRINSICS) < 1e-6);
    for (int c = 0; c < 2; c++)
        CHECK(normalError(call, truth, c) < 1e-5);
    CHECK(largestPointError(call, scene) < 1e-3);
}

TEST_CASE("Known R and T are a scale, as are known poses", "[bundle]")
{
    Random random(5);
    const RigTruth pair = wandRig(2);
    BundleScene scene = makeWandScene(pair, 40, random, 0);
    scene.lengths.clear();
    BundleCall standing(pair, scene, random);
    standing.Rs[1] = Mat(pair.Rs[1], true);
    standing.Ts[1] = Mat(pair.Ts[1], true);
    CHECK(standing.run(0) < 1e-6);
    CHECK(normalError(standing, pair, 1) < 1e-5);

    const RigTruth one = oneCamera();
    scene = makeMovingScene(one, 6, 50, random, 0);
    scene.lengths.clear();
    BundleCall exact(one, scene, random), uncertain(one, scene, random, 0);
    for (size_t view = 0; view < scene.rvecs.size(); view++)
    {
        exact.rvecs[view] = Mat(scene.rvecs[view], true);
        exact.tvecs[view] = Mat(scene.tvecs[view], true);
        Mat covariance = Mat::eye(6, 6, CV_64F);
        covariance(Rect(0, 0, 3, 3)) *= 1e-6;
        uncertain.poseCovariances.push_back(covariance*0.01);
    }
    CHECK(exact.run(GLASS_USE_POSES) < 1e-6);
    CHECK(normalError(exact, one, 0) < 1e-5);
    CHECK(uncertain.run(GLASS_USE_POSES) < 1e-6);
    CHECK(normalError(uncertain, one, 0) < 1e-5);
    CHECK(largestPointError(uncertain, scene) < 1e-4);
}

TEST_CASE("Rotations that are known, as of an IMU, need no pose, and poses without them no rotation", "[bundle]")
{
    CAPTURE(seed());
    Random random(7);
    const RigTruth one = oneCamera();
    const BundleScene scene = makeMovingScene(one, 6, 50, random, 0);
    for (int known : { 0, 3 })
    {
        CAPTURE(known);
        BundleCall call(one, scene, random, 0.5);
        Mat covariance = Mat::eye(6, 6, CV_64F)*NaN;
        for (int i = 0; i < 3; i++)
            covariance.at<double>(known + i, known + i) = known == 0 ? 1e-10 : 1e-6;
        for (size_t view = 0; view < scene.rvecs.size(); view++)
        {
            (known == 0 ? call.rvecs : call.tvecs)[view] = Mat(known == 0 ? scene.rvecs[view] : scene.tvecs[view], true);
            call.poseCovariances.push_back(covariance);
        }
        CHECK(call.run(GLASS_USE_POSES) < 1e-6);
        CHECK(normalError(call, one, 0) < 1e-5);
        CHECK(largestPointError(call, scene) < 1e-3);
        CHECK(call.stdDeviations.at<double>(8) > 0);
    }
}

TEST_CASE("With GLASS_FIX_NORMAL cameras stay as they are, also without windows", "[bundle]")
{
    Random random(6);
    RigTruth truth = oneCamera(1);
    for (bool hasWindow : { true, false })
    {
        if (!hasWindow)
            truth.cameras[0]->setWindow(GlassWindow());
        const BundleScene scene = makeMovingScene(truth, 4, 30, random, 0);
        BundleCall call(truth, scene, random);
        call.cameras[0]->setWindow(truth.cameras[0]->window());
        CHECK(call.run(GLASS_FIX_NORMAL) < 1e-6);
        CHECK(largestPointError(call, scene) < 1e-4);
        CHECK(countNonZero(call.covariance) == 0);
        CHECK(call.pointDeviations.at<double>(5, 2) > 0);
        if (!hasWindow)
            CHECK_THAT(thrown([&] { call.run(0); }), Catch::Contains("normal is undetermined"));
    }
}

TEST_CASE("What was seen once is NaN, and its image's mask is 0 where it was not seen", "[bundle]")
{
    Random random(7);
    const RigTruth truth = wandRig();
    BundleScene scene = makeWandScene(truth, 30, random, 0.1);
    const Point2d nowhere(NaN, NaN);
    scene.pixels[0][0][10] = scene.pixels[1][0][10] = nowhere;
    scene.pixels[2][0][20] = nowhere;
    BundleCall call(truth, scene, random);
    call.run(GLASS_FREE_EXTRINSICS);
    CHECK(std::isnan(call.points[10].x));
    CHECK(std::isnan(call.pointDeviations.at<double>(10, 0)));
    CHECK(std::isfinite(call.points[11].z));
    CHECK(std::isfinite(call.points[20].z));
    CHECK(call.inliers[2].at<uchar>(10) == 0);
    CHECK(call.inliers[2].at<uchar>(20) == 0);
    CHECK(call.inliers[2].at<uchar>(11) == 1);
}

TEST_CASE("Wrong matches are found and left out", "[bundle]")
{
    CAPTURE(seed());
    Random random(8);
    const RigTruth truth = wandRig(4);
    BundleScene scene = makeWandScene(truth, 100, random, 0.1);
    BundleCall clean(truth, scene, random);
    Random again(8);
    std::vector<std::pair<int, int> > wrong;
    for (int i = 0; i < 200; i += 10)
    {
        const int c = random.below(4);
        scene.pixels[c][0][i] += Point2d(random.uniform(5, 40), -random.uniform(5, 40));
        wrong.push_back({ c, i });
    }
    BundleCall robust(truth, scene, random), naive(truth, scene, random);
    clean.run(GLASS_FREE_EXTRINSICS);
    naive.run(GLASS_FREE_EXTRINSICS);
    robust.run(GLASS_FREE_EXTRINSICS | GLASS_ROBUST);
    for (const auto& w : wrong)
        CHECK(robust.inliers[w.first].at<uchar>(w.second) == 0);
    int lost = 0;               // of what is right and was of use
    for (int c = 0; c < 4; c++)
        for (int i = 0; i < 200; i++)
            lost += i % 10 != 0 && clean.inliers[c].at<uchar>(i) && !robust.inliers[c].at<uchar>(i);
    CHECK(lost <= 3);           // the chance is 1e-4 each on average, more where a point absorbs little of its error
    for (int c = 0; c < 4; c++)
    {
        CHECK(normalError(robust, truth, c) < 2*normalError(clean, truth, c) + 0.02);
        CHECK(normalError(robust, truth, c) < 0.5*normalError(naive, truth, c) + 0.02);
    }
}

TEST_CASE("The reduced normal equations are the inverse of the whole bound", "[bundle]")
{
    CAPTURE(seed());
    const double sigma = 0.1;
    for (bool moves : { false, true })
    {
        CAPTURE(moves);
        Random random(9);
        const RigTruth truth = wandRig(2);
        BundleScene scene = moves ? makeMovingScene(truth, 4, 20, random, 0) : makeWandScene(truth, 15, random, 0, 0.05);
        keepWhatAllSee(scene);
        REQUIRE(!scene.lengths.empty());
        const BundleBound bound(truth, scene, BundleBound::NORMAL | BundleBound::DISTANCE | BundleBound::EXTRINSICS, sigma);

        const std::unique_ptr<Problem> bundle = bundleAt(truth, scene, sigma, GLASS_FREE_DISTANCE | GLASS_FREE_EXTRINSICS);
        CHECK(newtonDecrement(informationOf(*bundle)) < 1e-6);
        Covariance covariance;
        REQUIRE(covariance.compute(*bundle, sigma*sigma, 0).converged());
        Mat stated;
        eigen2cv(covariance.ofParameters, stated);
        for (int c = 0; c < 2; c++)
        {
            const int first = 16*c + 8;         // 8 of the lens
            const Mat T(tangentsOf(truth.cameras[c]->window().normal));
            const Mat normal = T.t()*stated(Rect(first, first, 3, 3))*T;
            const Mat expected = bound.ofCamera(c);
            CHECK(largestDifference(normal, expected(Rect(0, 0, 2, 2))) < 1e-6*expected.at<double>(0, 0));
            CHECK(stated.at<double>(first + 3, first + 3) == Approx(expected.at<double>(2, 2)).epsilon(1e-6));
        }
    }
}

TEST_CASE("What is hardly known is as uncertain in points as in cameras", "[bundle]")
{
    CAPTURE(seed());
    const double sigma = 0.1;
    for (bool moves : { false, true })
        for (double lengthSigma : { 0.02, 1., 100., 1e4 })
        {
            CAPTURE(moves, lengthSigma);
            Random random(15);
            const RigTruth truth = wandRig(2, 1);
            BundleScene scene = moves ? makeMovingScene(truth, 4, 20, random, 0) : makeWandScene(truth, 15, random, 0);
            for (Vec4d& length : scene.lengths)
                length[3] = lengthSigma;
            keepWhatAllSee(scene);
            REQUIRE(!scene.lengths.empty());
            const std::unique_ptr<Problem> bundle = bundleAt(truth, scene, sigma, GLASS_FREE_EXTRINSICS);
            Covariance covariance;
            REQUIRE(covariance.compute(*bundle, sigma*sigma, 0).converged());
            const Eigen::MatrixXd& stated = covariance.ofParameters;
            const Mat_<double> ofPoints = covariance.ofPoints();
            const BundleBound bound(truth, scene, BundleBound::NORMAL | BundleBound::EXTRINSICS, sigma);
            const int T = (int)stated.rows() - 3;
            for (int i = 0; i < 3; i++)
            {
                CHECK(std::sqrt(stated(T + i, T + i)) == Approx(bound.translation(1, i)).epsilon(2e-3));
                for (size_t point = 0; point < scene.points.size(); point++)
                    CHECK(ofPoints((int)point, i) == Approx(bound.point((int)point, i)).epsilon(2e-3));
            }
        }
}

TEST_CASE("Results do not depend on the number of threads", "[bundle]")
{
    Random random(10);
    const RigTruth truth = wandRig();
    const BundleScene scene = makeWandScene(truth, 30, random, 0.1);
    const int threads = getNumThreads();
    std::vector<BundleCall> calls;
    std::vector<double> rms;
    for (int count : { 1, 2, 3 })
    {
        Random start(11);
        setNumThreads(count);
        calls.emplace_back(truth, scene, start);
        rms.push_back(calls.back().run(GLASS_FREE_EXTRINSICS));
    }
    setNumThreads(threads);
    const BundleCall& one = calls[0];
    for (size_t k = 1; k < calls.size(); k++)
    {
        const BundleCall& other = calls[k];
        CAPTURE(k + 1);
        CHECK(rms[k] == rms[0]);
        CHECK(largestDifference(one.covariance, other.covariance) == 0);
        CHECK(largestDifference(one.stdDeviations, other.stdDeviations) == 0);
        CHECK(largestDifference(one.pointDeviations, other.pointDeviations) == 0);
        CHECK(largestDifference(one.perViewErrors, other.perViewErrors) == 0);
        CHECK(largestDifference(Mat(one.points), Mat(other.points)) == 0);
        for (size_t c = 0; c < one.cameras.size(); c++)
        {
            CHECK(largestDifference(one.Rs[c], other.Rs[c]) == 0);
            CHECK(largestDifference(one.Ts[c], other.Ts[c]) == 0);
            CHECK(largestDifference(one.cameras[c]->lensParameters(), other.cameras[c]->lensParameters()) == 0);
            CHECK(one.cameras[c]->window().normal == other.cameras[c]->window().normal);
            CHECK(one.cameras[c]->window().distance == other.cameras[c]->window().distance);
        }
    }
}

TEST_CASE("What is wrong with the arguments, and what nothing determines, is said", "[bundle]")
{
    Random random(12);
    const RigTruth truth = wandRig(2);
    const BundleScene scene = makeWandScene(truth, 20, random, 0.1);
    const auto fault = [&](const std::function<void(BundleCall&)>& spoil, int flags)
    {
        Random start(13);
        BundleCall call(truth, scene, start);
        spoil(call);
        return thrown([&] { call.run(flags); });
    };
    using Catch::Contains;
    const int R_T = GLASS_FREE_EXTRINSICS;
    CHECK_THAT(fault([](BundleCall& c) { c.lengths.clear(); }, R_T), Contains("nothing tells the scale"));
    CHECK_THAT(fault([](BundleCall& c) { c.lengths[3][1] = 40; }, R_T), Contains("lengths[3] is between points 6 and 40"));
    CHECK_THAT(fault([](BundleCall& c) { c.lengths[3][1] = 6; }, R_T), Contains("two different ones"));
    CHECK_THAT(fault([](BundleCall& c) { c.lengths[3][0] = NaN; }, R_T), Contains("lengths[3]"));
    CHECK_THAT(fault([](BundleCall& c) { c.lengths[3][3] = 0; }, R_T), Contains("standard deviation of 0"));
    CHECK_THAT(fault([](BundleCall& c) { c.lengths[3][2] = -1; }, R_T), Contains("must be positive"));
    CHECK_THAT(fault([](BundleCall& c) { c.images.pop_back(); }, R_T), Contains("imagePoints has 1 elements"));
    CHECK_THAT(fault([](BundleCall& c) { c.images[1][0] = c.images[1][0].rowRange(0, 9); }, R_T),
               Contains("imagePoints[1][0] has 9 points"));
    CHECK_THAT(fault([](BundleCall& c) { c.images[1].push_back(c.images[1][0]); }, R_T), Contains("has 2 views"));
    CHECK_THAT(fault([](BundleCall& c) { c.points.resize(7); }, R_T), Contains("the scene has 7"));
    CHECK_THAT(fault([](BundleCall& c) { c.cameras[1] = c.cameras[0]; }, R_T), Contains("one object"));
    CHECK_THAT(fault([](BundleCall&) {}, R_T | GLASS_SHARED_WINDOW), Contains("no meaning here"));
    CHECK_THAT(fault([](BundleCall& c) { c.rvecs.clear(); }, R_T), Contains("rvecs has 0 vectors"));
    CHECK_THAT(fault([](BundleCall& c) { c.images[1][0] = c.images[1][0]*NaN; }, R_T), Contains("imagePoints[1] has no point"));

    // A window that the second camera cannot look through, as it is turned to the side.
    CHECK_THAT(fault([](BundleCall& c) { c.windows = { 0, 0 }; Rodrigues(Vec3d(0, 2, 0), c.Rs[1]); }, R_T),
               Contains("shared window: camera 2"));
    // One camera that stands still sees every point once.
    BundleCall alone(oneCamera(), makeWandScene(oneCamera(), 20, random, 0.1), random);
    CHECK_THAT(thrown([&] { alone.run(0); }), Contains("lengths has none between two points that are seen in two images"));
    // A pane in air has no distance.
    const RigTruth inAir = wandRig(2, 1);
    BundleCall distance(inAir, makeWandScene(inAir, 20, random, 0.1), random);
    CHECK_THAT(thrown([&] { distance.run(R_T | GLASS_FREE_DISTANCE); }), Contains("GLASS_FREE_DISTANCE"));
    Random few(14);
    BundleCall little(truth, makeWandScene(truth, 2, few, 0.1), few);
    CHECK_THAT(thrown([&] { little.run(R_T | GLASS_FREE_DISTANCE); }), Contains("fewer than are needed"));
}

TEST_CASE("An earlier calibration has its say in a bundle: all, nothing, and in between as information adds up", "[bundle][prior]")
{
    CAPTURE(seed());
    Random random(21);
    const RigTruth truth = wandRig(2);
    const BundleScene scene = makeWandScene(truth, 240, random, 0.1);
    const int FREE = GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE, P = 2*(8 + 8) + 6;
    const std::vector<int> ofDistances = { 8 + 3, 16 + 8 + 3 };
    const auto started = [&] { Random start(22); return BundleCall(truth, scene, start, 0.5); };
    BundleCall free = started();
    free.run(FREE);
    REQUIRE(free.covariance.rows == P);
    // Known next to nothing: as free. The normal's prior has rank 2.
    Mat vague = Mat::zeros(P, P, CV_64F);
    BundleCall known = started();
    for (int c = 0; c < 2; c++)
    {
        const Vec3d n = known.cameras[c]->window().normal;
        Mat(1e2*(Matx33d::eye() - n*n.t())).copyTo(vague(Rect(16*c + 8, 16*c + 8, 3, 3)));
        vague.at<double>(ofDistances[c], ofDistances[c]) = 1e8;
    }
    for (int i = 32; i < P; i++)
        vague.at<double>(i, i) = 1e8;
    known.run(vague, 0, GLASS_FIX_NORMAL);
    // Twelve numbers more that are known are as many degrees of freedom, a percent, by which the pixels weigh more against lengths.
    for (int i = 0; i < 3; i++)
    {
        const double byT = known.Ts[1].at<double>(i) - free.Ts[1].at<double>(i);
        const double byNormal = known.cameras[1]->window().normal[i] - free.cameras[1]->window().normal[i];
        CHECK(std::abs(byT) < 0.05*free.stdDeviations.at<double>(35 + i));
        CHECK(std::abs(byNormal) < 0.05*free.stdDeviations.at<double>(16 + 8 + i));
    }
    for (int i = 0; i < P; i++)
    {
        CAPTURE(i);
        CHECK(known.stdDeviations.at<double>(i) == Approx(free.stdDeviations.at<double>(i)).epsilon(0.02).margin(1e-12));
    }
    // Known as well as exactly: stays.
    Random atTruth(22);
    BundleCall held(truth, scene, atTruth, 0);
    Mat exact = Mat::zeros(P, P, CV_64F);
    for (int i : { 8 + 3, 16 + 8 + 3, 32, 33, 34, 35, 36, 37 })
        exact.at<double>(i, i) = i < 32 || i > 34 ? 1e-8 : 1e-14;
    const Mat before = held.Ts[1].clone();
    held.run(exact, 0, GLASS_FIX_NORMAL);
    CHECK(largestDifference(held.Ts[1], before) < 5e-4);
    CHECK(held.stdDeviations.at<double>(35) == Approx(1e-4).epsilon(0.01));
    // The covariance of the free fit, from which another one starts: half the variances, with the correlations.
    BundleCall again = started();
    again.cameras = free.cameras;
    again.Rs = free.Rs;
    again.Ts = free.Ts;
    again.run(free.covariance, 0, GLASS_FIX_NORMAL);
    for (int i = 0; i < P; i++)
    {
        CAPTURE(i);
        CHECK(again.stdDeviations.at<double>(i) == Approx(free.stdDeviations.at<double>(i)*std::sqrt(0.5)).epsilon(0.1).margin(1e-12));
    }
}

TEST_CASE("An error that all lengths share is in every length, however many there are", "[bundle][prior]")
{
    CAPTURE(seed());
    const double SHARED = 2e-3;
    Random random(23);
    const RigTruth truth = wandRig(3);
    const BundleScene scene = makeWandScene(truth, 60, random, 0.1);
    const auto fitted = [&](double shared)
    {
        Random start(24);
        BundleCall call(truth, scene, start, 0.5);
        call.run(Mat(), shared, GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE);
        return call;
    };
    const BundleCall own = fitted(0), shared = fitted(SHARED);
    const int P = (int)own.stdDeviations.total();
    REQUIRE((int)shared.stdDeviations.total() == P);
    // Nearly all lengths of the problem scale with those that are given; thickness is given by itself.
    for (int i = 0; i < 3; i++)
    {
        const double T = own.Ts[2].at<double>(i), alone = own.stdDeviations.at<double>(P - 3 + i);
        const double expected = std::sqrt(alone*alone + std::pow(SHARED*T, 2));
        CHECK(shared.stdDeviations.at<double>(P - 3 + i) == Approx(expected).epsilon(0.1));
        CHECK(shared.Ts[2].at<double>(i) == Approx(T).epsilon(1e-4).margin(0.05));
    }
    for (size_t i = 0; i < scene.points.size(); i += 7)
    {
        const double alone = own.pointDeviations.at<double>((int)i, 2);
        const double expected = std::sqrt(alone*alone + std::pow(SHARED*scene.points[i].z, 2));
        CAPTURE(i, alone);
        if (std::isfinite(own.points[i].x))
            CHECK(shared.pointDeviations.at<double>((int)i, 2) == Approx(expected).epsilon(0.1));
    }
}

TEST_CASE("What is no covariance of the rig is refused by name", "[bundle][prior]")
{
    Random random(25);
    const RigTruth truth = wandRig(2);
    const BundleScene scene = makeWandScene(truth, 20, random, 0.1);
    const int P = 2*(8 + 8) + 6;
    const auto fault = [&](const Mat& covariance, double shared)
    {
        Random start(26);
        BundleCall call(truth, scene, start, 0.5);
        return thrown([&] { call.run(covariance, shared, GLASS_FREE_EXTRINSICS); });
    };
    using Catch::Contains;
    CHECK_THAT(fault(Mat::eye(P + 1, P + 1, CV_64F), 0), Contains("it must be 38x38"));
    Mat bad = Mat::eye(P, P, CV_64F);
    bad.at<double>(3, 3) = INF;
    CHECK_THAT(fault(bad, 0), Contains("rigCovariance has inf in row 3, column 3"));
    bad.at<double>(3, 3) = -1;
    CHECK_THAT(fault(bad, 0), Contains("the variance -1 in row 3"));
    bad.at<double>(3, 3) = 1;
    bad.at<double>(3, 4) = bad.at<double>(4, 3) = 2;
    CHECK_THAT(fault(bad, 0), Contains("rigCovariance is not positive semidefinite"));
    bad.at<double>(4, 3) = 0.5;
    CHECK_THAT(fault(bad, 0), Contains("rigCovariance is not symmetric: it has 2 in row 3, column 4, but 0.5 in row 4, column 3"));
    CHECK_THAT(fault(Mat(), -1), Contains("lengthScaleStd is -1"));
    Random start(26);
    BundleCall both(truth, scene, start, 0.5);
    BundleAdjustOptions options;
    options.cameraCovariances.resize(2);
    options.rigCovariance = Mat::eye(P, P, CV_64F);
    CHECK_THAT(thrown([&] { both.run(options); }), Contains("cameraCovariances and rigCovariance are both given"));
    CHECK_THAT(fault(Mat(), NaN), Contains("lengthScaleStd"));
}

TEST_CASE("Who asks a bundle adjustment for iterations alone gets them, whatever epsilon is", "[bundle]")
{
    for (int flags : { 0, (int)GLASS_ROBUST })
    {
        std::vector<double> rms;
        for (double epsilon : { 0., 1. })
        {
            Random random(63);
            CAPTURE(seed(), flags, epsilon);
            const RigTruth truth = oneCamera();
            const BundleScene scene = makeMovingScene(truth, 6, 50, random, 0.1);
            BundleCall call(truth, scene, random);
            BundleAdjustOptions options(flags);
            options.criteria = TermCriteria(TermCriteria::COUNT, 50, epsilon);
            rms.push_back(call.run(options));
        }
        CHECK(rms[0] == rms[1]);
        CHECK(rms[0] < 0.2);
    }
}
