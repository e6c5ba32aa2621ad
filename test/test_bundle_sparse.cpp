// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Bundles of a list of observations, and the sparse system behind them.
#include "adjust/damped_steps.hpp"
#include "adjust/linearize.hpp"
#include "adjust/ray_midpoints.hpp"
#include "bundle_scenes.hpp"
#include "math/dense.hpp"
#include "problem_scenes.hpp"
#include <opencv2/core/eigen.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Eigen::MatrixXd;

namespace {

//! A call with the list of what another has in arrays.
struct ListCall
{
    explicit ListCall(const BundleCall& dense) : call(dense)
    {
        for (Ptr<RefractiveCamera>& camera : call.cameras)
            camera = camera->clone();
        for (std::vector<Mat>* results : { &call.Rs, &call.Ts, &call.rvecs, &call.tvecs })
            for (Mat& result : *results)
                result = result.clone();
        for (int c = 0; c < (int)dense.images.size(); c++)
            for (int view = 0; view < (int)dense.images[c].size(); view++)
                for (int i = 0; i < dense.images[c][view].rows; i++)
                {
                    observations.push_back(Vec3i(view, c, i));
                    pixels.push_back(dense.images[c][view].at<Point2d>(i));
                }
        call.points.assign(dense.images[0][0].rows, Point3d(NaN, NaN, NaN));
    }
    void shuffle(Random& random)
    {
        for (size_t i = observations.size() - 1; i > 0; i--)
        {
            const size_t other = (size_t)(random.uniform(0, 1)*(double)i);
            std::swap(observations[i], observations[other]);
            std::swap(pixels[i], pixels[other]);
        }
    }
    double run(int flags)
    {
        BundleAdjustOptions options(flags);
        options.poseCovariances = call.poseCovariances;
        options.rigCovariance = rigCovariance;
        options.covarianceMemory = memory;
        if (!pixelCovariances.empty())
            options.pixelCovariances = { { pixelCovariances } };
        static_cast<BundleAdjustResult&>(call) = refractiveBundleAdjust(observations, pixels, call.cameras, call.windows, call.Rs, call.Ts,
                                                                        call.rvecs, call.tvecs, call.points, call.lengths, options);
        inliers = call.inliers[0];
        return call.rms;
    }

    BundleCall call;
    std::vector<Vec3i> observations;
    std::vector<Point2d> pixels;
    Mat pixelCovariances, rigCovariance;
    double memory = 0;
    std::vector<uchar> inliers;
};

RigTruth movingPair()
{
    return makeRig(2, { 0, 1 }, 1.333);
}

/** A camera along a strip, in whose images few points are in common with those of far ones.
@param perView new points. @param step from view to view, mm */
BundleScene makeStrip(const RigTruth& rig, int views, Random& random, double sigma, int perView = 14, double step = 40)
{
    const double RANGE = 600, LENGTH = step*views + 120;
    const int count = perView*views;
    BundleScene scene;
    for (int i = 0; i < count; i++)
        scene.points.push_back({ LENGTH*(i + random.uniform(0, 1))/count - 80, random.uniform(-65, 65), random.uniform(-30, 30) });
    for (int view = 0; view < views; view++)
    {
        const Vec3d rvec = view == 0 ? Vec3d() : random.vector(0.04);
        Matx33d R;
        Rodrigues(rvec, R);
        scene.rvecs.push_back(rvec);
        scene.tvecs.push_back(-(R*(Vec3d(step*view, 0, -RANGE) + random.vector(10))));
    }
    for (int i = 0; i + 1 < (int)scene.points.size(); i += 10)
        scene.lengths.push_back({ (double)i, i + 1., norm(scene.points[i] - scene.points[i + 1]), 0.1 });
    look(rig, random, sigma, 0.05, scene);
    return scene;
}

} // namespace

TEST_CASE("A list of observations gives what the arrays give, in any order", "[bundle][sparse]")
{
    CAPTURE(seed());
    for (int flags : { 0, (int)GLASS_ROBUST })
    {
        CAPTURE(flags);
        Random random(41);
        const RigTruth truth = movingPair();
        BundleScene scene = makeMovingScene(truth, 6, 30, random, 0.1, 0.2);
        scene.pixels[0][1][3].x = NaN;          // halves
        scene.pixels[1][2][5].y = NaN;
        if (flags)
            scene.pixels[0][2][7] += Point2d(12, -9);
        BundleCall dense(truth, scene, random);
        ListCall list(dense);
        list.shuffle(random);
        const double rms = dense.run(flags | GLASS_FREE_DISTANCE);
        CHECK(list.run(flags | GLASS_FREE_DISTANCE) == rms);
        CHECK(largestDifference(Mat(list.call.points), Mat(dense.points)) == 0);
        CHECK(largestDifference(list.call.covariance, dense.covariance) == 0);
        CHECK(largestDifference(list.call.stdDeviations, dense.stdDeviations) == 0);
        REQUIRE(list.call.viewCovariances.size() == dense.viewCovariances.size());
        CHECK(largestDifference(list.call.viewCovariances[5], dense.viewCovariances[5]) == 0);
        CHECK(list.call.pixelStd == dense.pixelStd);
        CHECK(list.call.degreesOfFreedom == dense.degreesOfFreedom);
        CHECK(largestDifference(list.call.pointDeviations, dense.pointDeviations) == 0);
        CHECK(largestDifference(list.call.perViewErrors, dense.perViewErrors) == 0);
        int rejected = 0;
        for (size_t i = 0; i < list.observations.size(); i++)
        {
            const Vec3i& o = list.observations[i];
            CHECK(list.inliers[i] == dense.inliers[o[0]*2 + o[1]].at<uchar>(o[2]));
            rejected += isSeen(list.pixels[i]) && !list.inliers[i];
        }
        CHECK((rejected > 0) == (flags != 0));
        for (size_t view = 0; view < dense.rvecs.size(); view++)
        {
            CHECK(largestDifference(list.call.rvecs[view], dense.rvecs[view]) == 0);
            CHECK(largestDifference(list.call.tvecs[view], dense.tvecs[view]) == 0);
        }
        // Again from the result: it stays.
        const std::vector<Point3d> before = list.call.points;
        CHECK(list.run(flags | GLASS_FREE_DISTANCE) == Approx(rms).epsilon(1e-6));
        CHECK(largestDifference(Mat(list.call.points), Mat(before)) < 1e-3);
    }
}

TEST_CASE("Two rows of one point in one image are two observations", "[bundle][sparse]")
{
    CAPTURE(seed());
    Random random(42);
    const RigTruth truth = movingPair();
    const BundleScene scene = makeMovingScene(truth, 5, 25, random, 0.1);
    const BundleCall start(truth, scene, random);
    ListCall single(start), twice(start), certain(start);
    single.run(GLASS_FREE_EXTRINSICS);
    const size_t count = twice.pixels.size();
    for (size_t i = 0; i < count; i += 2)
    {
        twice.observations.push_back(twice.observations[i]);
        twice.pixels.push_back(twice.pixels[i]);
    }
    twice.run(GLASS_FREE_EXTRINSICS);
    CHECK(twice.inliers.size() == twice.pixels.size());
    // As one of half the variance.
    Mat_<double> covariances((int)count, 3, 0.);
    for (int i = 0; i < (int)count; i++)
        covariances(i, 0) = covariances(i, 2) = i % 2 == 0 ? 0.5 : 1;
    certain.pixelCovariances = covariances;
    certain.run(GLASS_FREE_EXTRINSICS);
    CHECK(largestDifference(Mat(twice.call.points), Mat(certain.call.points)) < 2e-3);
    CHECK(largestDifference(Mat(twice.call.points), Mat(single.call.points)) > 5e-3);
}

TEST_CASE("A view that nothing is seen in has no pose", "[bundle][sparse]")
{
    Random random(43);
    const RigTruth truth = movingPair();
    const BundleScene scene = makeMovingScene(truth, 5, 25, random, 0.1);
    ListCall list(BundleCall(truth, scene, random));
    for (size_t i = list.observations.size(); i-- > 0;)
        if (list.observations[i][0] == 2)
        {
            list.observations.erase(list.observations.begin() + i);
            list.pixels.erase(list.pixels.begin() + i);
        }
    list.call.rvecs[2] = Mat(Vec3d(NaN, NaN, NaN), true);
    list.run(0);
    REQUIRE(list.call.viewCovariances.size() == 5);
    CHECK(std::isnan(list.call.rvecs[2].at<double>(0)));
    CHECK(std::isnan(list.call.tvecs[2].at<double>(2)));
    CHECK(std::isnan(list.call.perViewErrors.at<double>(2, 1)));
    CHECK(std::isnan(list.call.viewCovariances[2].at<double>(0, 0)));
    CHECK(countNonZero(list.call.viewCovariances[0]) == 0);      // the frame
    CHECK(list.call.viewCovariances[1].at<double>(5, 5) > 0);
}

TEST_CASE("What is wrong with a list is said", "[bundle][sparse]")
{
    Random random(44);
    const RigTruth truth = movingPair();
    const BundleScene scene = makeMovingScene(truth, 4, 20, random, 0.1);
    const BundleCall start(truth, scene, random);
    const auto fault = [&](const std::function<void(ListCall&)>& spoil)
    {
        ListCall list(start);
        spoil(list);
        return thrown([&] { list.run(0); });
    };
    using Catch::Contains;
    CHECK_THAT(fault([](ListCall& l) { l.observations[7][0] = 4; }), Contains("observations[7] is of view 4, but rvecs has 4"));
    CHECK_THAT(fault([](ListCall& l) { l.observations[7][1] = 2; }), Contains("observations[7] is of camera 2, but cameras has 2"));
    CHECK_THAT(fault([](ListCall& l) { l.observations[7][2] = -1; }), Contains("observations[7] is of point -1, but points3D has 20"));
    CHECK_THAT(fault([](ListCall& l) { l.call.points.clear(); l.observations[3][2] = -1; }), Contains("point -1; it must be a whole"));
    CHECK_THAT(fault([](ListCall& l) { l.call.points.clear(); l.observations[3][2] = 2000000000; }),
               Contains("observations[3] is of point 2000000000, but 160 observations are of 160 at most") && Contains("points3D"));
    CHECK_THAT(fault([](ListCall& l) { l.pixels.pop_back(); }), Contains("imagePoints has 159 pixels, but observations has 160 rows"));
    CHECK_THAT(fault([](ListCall& l) { l.observations.clear(); }), Contains("observations is empty"));
    CHECK_THAT(fault([](ListCall& l) { l.call.cameras.clear(); }), Contains("cameras is empty"));
    CHECK_THAT(fault([](ListCall& l) { l.memory = -1; }), Contains("covarianceMemory is -1"));
    CHECK_THAT(fault([](ListCall& l) { l.memory = NaN; }), Contains("covarianceMemory is nan"));
    CHECK_THAT(fault([](ListCall& l) { l.pixelCovariances = Mat::ones(3, 3, CV_64F); }), Contains("pixelCovariances"));
    BundleAdjustOptions asImages;
    asImages.pixelCovariances.assign(2, std::vector<Mat>(4));
    ListCall list(start);
    CHECK_THAT(thrown([&] { refractiveBundleAdjust(list.observations, list.pixels, list.call.cameras, list.call.windows, list.call.Rs,
                                                   list.call.Ts, list.call.rvecs, list.call.tvecs, list.call.points, list.call.lengths,
                                                   asImages); }), Contains("pixelCovariances is 2 lists, the first of 4 arrays"));
    CHECK_THAT(fault([](ListCall& l) { for (Point2d& p : l.pixels) p = Point2d(NaN, NaN); }), Contains("has no point that was seen"));
    // A view of two points has no pose, and is named.
    CHECK_THAT(fault([](ListCall& l)
               {
                   for (size_t i = 0; i < l.observations.size(); i++)
                       if (l.observations[i][0] == 3 && (l.observations[i][2] > 1 || l.observations[i][1] > 0))
                           l.pixels[i] = Point2d(NaN, NaN);
               }), Contains("view 3") || Contains("view 4"));
    ListCall numbers(start);        // whole numbers of floating point, as of NumPy
    Mat rows;
    Mat(numbers.observations).convertTo(rows, CV_64F);
    const auto run = [&] { return refractiveBundleAdjust(rows, numbers.pixels, numbers.call.cameras, numbers.call.windows, numbers.call.Rs,
        numbers.call.Ts, numbers.call.rvecs, numbers.call.tvecs, numbers.call.points, numbers.call.lengths, BundleAdjustOptions()).rms; };
    CHECK(run() > 0);
    rows.at<Vec3d>(2)[2] = 1.5;
    CHECK_THAT(thrown(run), Contains("observations[2] is of point 1.5"));
}

TEST_CASE("Without memory for the views' covariances points have those of known views", "[bundle][sparse]")
{
    CAPTURE(seed());
    Random random(49);
    const RigTruth truth = makeRig(1, { 0 }, 1.333);
    const BundleScene scene = makeStrip(truth, 9, random, 0.1);
    const BundleCall start(truth, scene, random);
    ListCall all(start), enough(start), little(start);
    all.run(0);
    enough.memory = 1e9;
    enough.run(0);
    little.memory = 1000;
    little.run(0);
    CHECK(largestDifference(Mat(little.call.points), Mat(all.call.points)) == 0);
    CHECK(largestDifference(little.call.covariance, all.call.covariance) == 0);
    CHECK(largestDifference(enough.call.pointDeviations, all.call.pointDeviations) == 0);
    CHECK(countNonZero(little.call.viewCovariances[0]) == 0);        // the scene's frame
    for (int view = 1; view < 9; view++)
    {
        CHECK(largestDifference(enough.call.viewCovariances[view], all.call.viewCovariances[view]) == 0);
        CHECK(countNonZero(little.call.viewCovariances[view] == little.call.viewCovariances[view]) == 0);         // NaN
    }
    // The same where cameras and views are known. The noise follows from the residuals, of fewer unknowns.
    ListCall known(little);
    known.memory = 0;
    const double rms = known.run(GLASS_FIX_NORMAL | GLASS_USE_POSES);
    CHECK(rms == Approx(all.run(0)).epsilon(1e-3));
    const double noise = little.call.pixelStd/known.call.pixelStd;
    for (int i = 0; i < little.call.pointDeviations.rows; i++)
        for (int k = 0; k < 3; k++)
        {
            const double own = little.call.pointDeviations.at<double>(i, k), other = known.call.pointDeviations.at<double>(i, k);
            if (!std::isfinite(own))
                continue;
            // (A/noise^2 + B)^-1, A of the pixels and B of the lengths: where B counts it grows by less than noise^2, and the two fits
            // weigh it differently, so that their points are a little apart.
            const bool hasLength = i % 10 < 2;
            const double least = hasLength ? std::min(noise, 1.) : noise, most = hasLength ? std::max(noise, 1.) : noise;
            const double rounding = hasLength ? 1e-4 : 1e-6;
            CHECK(own >= least*other*(1 - rounding));
            CHECK(own <= most*other*(1 + rounding));
            CHECK(own < all.call.pointDeviations.at<double>(i, k));
        }
    CHECK(noise == Approx(1).epsilon(0.2));
}

TEST_CASE("Poses and points of a strip are as uncertain as the whole inverse says", "[bundle][sparse]")
{
    CAPTURE(seed());
    Random random(45);
    const double sigma = 0.1;
    const RigTruth truth = makeRig(1, { 0 }, 1.333);
    const BundleScene scene = makeStrip(truth, 9, random, 0);
    const std::unique_ptr<Problem> bundle = bundleAt(truth, scene, sigma, GLASS_FREE_INTRINSICS);
    bundle->setPoints(startPoints(*bundle, scene.points), {});
    Covariance covariance;
    REQUIRE(covariance.compute(*bundle, sigma*sigma, 0).converged());

    const FreeSpace space(*bundle);
    CHECK(informationOf(*bundle).poses.factor.column(0).rows.size() < 7);        // sparse: of eight poses
    const int outer = space.count, count = outer + bundle->scene().coordinateCount();
    MatrixXd information = MatrixXd::Zero(count, count);
    std::vector<int> firstOfPoint(scene.points.size(), -1);
    int next = outer;
    for (const Cluster& cluster : bundle->scene().clusters())
        for (int point : cluster.points)
        {
            firstOfPoint[point] = next;
            next += 3;
        }
    const std::vector<ImageRows> images = linearize(*bundle, space);
    for (size_t i = 0; i < images.size(); i++)
        for (int k = 0; k < images[i].residuals.size(); k++)
        {
            Eigen::VectorXd row = Eigen::VectorXd::Zero(count);
            const int point = bundle->images()[i].points.index[k/2];
            if (firstOfPoint[point] < 0)
                continue;
            row.segment<3>(firstOfPoint[point]) = images[i].inner.row(k).transpose();
            for (size_t c = 0; c < images[i].columns.size(); c++)
                row[images[i].columns[c]] = images[i].outer(k, c);
            information += row*row.transpose();
        }
    int at = outer;
    for (const Cluster& cluster : bundle->scene().clusters())
    {
        MatrixXd matrix = MatrixXd::Zero(cluster.size(), cluster.size());
        Eigen::VectorXd gradient = Eigen::VectorXd::Zero(cluster.size());
        cluster.addLengths(sigma, matrix, gradient);
        information.block(at, at, cluster.size(), cluster.size()) += matrix;
        at += cluster.size();
    }
    const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const MatrixXd whole = sigma*sigma*scale.asDiagonal()*inverse(scale.asDiagonal()*information*scale.asDiagonal())*scale.asDiagonal();

    const std::vector<Mat> ofPoses = covariance.ofPoses();
    for (int view = 1; view < 9; view++)
    {
        const int first = space.first[bundle->poseBlock(view)];
        for (int r = 0; r < 6; r++)
            for (int c = 0; c < 6; c++)
            {
                const double size = std::sqrt(whole(first + r, first + r)*whole(first + c, first + c));
                CHECK(std::abs(ofPoses[view].at<double>(r, c) - whole(first + r, first + c)) < 1e-5*size);
            }
    }
    const Mat_<double> ofPoints = covariance.ofPoints();
    for (size_t point = 0; point < scene.points.size(); point++)
        for (int k = 0; k < 3 && firstOfPoint[point] >= 0; k++)
            CHECK(ofPoints((int)point, k) == Approx(std::sqrt(whole(firstOfPoint[point] + k, firstOfPoint[point] + k))).epsilon(1e-5));
}

namespace {

//! What the fit of a strip takes from a start that is off.
struct Effort
{
    int steps, blocks;              //!< of the factor
    double gain;                    //!< that another step would have, of the squares
};

Effort effortOf(int views)
{
    Random random(48);
    const RigTruth truth = makeRig(1, { 0 }, 1.333);
    const BundleScene scene = makeStrip(truth, views, random, 0.1);
    const std::unique_ptr<Problem> problem = bundleAt(truth, scene, 0.1, 0);
    for (int view = 1; view < views; view++)
    {
        Pose pose = problem->pose(view);
        pose.rvec += random.vector(0.005);
        pose.tvec += random.vector(3);
        problem->setPose(view, pose);
    }
    problem->setPoints(startPoints(*problem, std::vector<Point3d>(scene.points.size(), Point3d(NaN, NaN, NaN))), {});
    ReducedCost cost(*problem);
    std::vector<Eigen::VectorXd> values;
    for (int block : cost.variableBlocks())
        values.push_back(problem->blocks()[block].values);
    std::vector<double*> state;
    for (Eigen::VectorXd& block : values)
        state.push_back(block.data());
    cost.setState(state);
    DampedSteps steps = { (double)problem->equationCount(), 1e-12, 1e-4, 30, false };
    steps.run(cost);
    REQUIRE(steps.isConverged);
    REQUIRE(cost.linearize());
    Effort effort = { steps.iterations, 0, 0 };
    const BlockCholesky& factor = cost.rootedInformation().poses.factor;
    for (int place = 0; place < factor.count(); place++)
        effort.blocks += 1 + (int)factor.column(place).rows.size();
    dampedStep(cost.information(), 0, effort.gain);
    effort.gain /= cost.squaredError();
    return effort;
}

} // namespace

TEST_CASE("A strip of four times as many views takes as many steps, and four times the blocks", "[bundle][sparse]")
{
    CAPTURE(seed());
    const Effort one = effortOf(24), four = effortOf(96);
    CAPTURE(one.steps, four.steps, one.blocks, four.blocks);
    CHECK(four.steps <= one.steps + 3);
    CHECK(four.steps < 15);
    CHECK(four.blocks <= 5*one.blocks);
    CHECK(four.gain < 1e-9);
}

TEST_CASE("A strip far from its origin converges to what it is near it", "[bundle][sparse]")
{
    CAPTURE(seed());
    Random random(49);
    const RigTruth truth = makeRig(1, { 0 }, 1.333);
    const BundleScene scene = makeStrip(truth, 24, random, 0.1);
    const BundleCall start(truth, scene, random);
    ListCall origin(start);
    const double rms = origin.run(GLASS_FREE_DISTANCE);
    for (const double far : { 1e6, 1e7 })
    {
        CAPTURE(far);
        ListCall farCall(start);
        const Vec3d shift(far, 0.5*far, 0);
        for (size_t view = 0; view < farCall.call.rvecs.size(); view++)
        {
            Matx33d R;
            Rodrigues(farCall.call.rvecs[view], R);
            farCall.call.tvecs[view] = farCall.call.tvecs[view] - Mat(R*shift);
        }
        CHECK(farCall.run(GLASS_FREE_DISTANCE) == Approx(rms).epsilon(1e-6));
        double largest = 0;
        int seen = 0;
        for (size_t i = 0; i < origin.call.points.size(); i++)
            if (std::isfinite(origin.call.points[i].x))
            {
                seen++;
                largest = std::max(largest, norm(farCall.call.points[i] - Point3d(shift) - origin.call.points[i]));
            }
        CHECK(seen > 250);
        CHECK(largest < 0.02);
    }
}

TEST_CASE("A strip's results do not depend on the number of threads", "[bundle][sparse]")
{
    Random random(46);
    const RigTruth truth = makeRig(1, { 0 }, 1.333);
    const BundleScene scene = makeStrip(truth, 12, random, 0.1);
    const int threads = getNumThreads();
    std::vector<ListCall> calls;
    std::vector<double> rms;
    for (int count : { 1, 3 })
    {
        Random start(11);
        setNumThreads(count);
        calls.emplace_back(BundleCall(truth, scene, start));
        rms.push_back(calls.back().run(GLASS_ROBUST));
    }
    setNumThreads(threads);
    CHECK(rms[0] == rms[1]);
    CHECK(largestDifference(calls[0].call.pointDeviations, calls[1].call.pointDeviations) == 0);
    CHECK(largestDifference(Mat(calls[0].call.points), Mat(calls[1].call.points)) == 0);
    CHECK(largestDifference(calls[0].call.viewCovariances.back(), calls[1].call.viewCovariances.back()) == 0);
}

namespace {

//! Robust fits of strips with wrong pixels.
struct WrongPixels
{
    int strips = 0, refused = 0, lostViews = 0, wrongViews = 0, lostEnds = 0, good = 0, lost = 0;
};

//! Moves one pixel in ten by up to 40 px in u and v. @return which
std::vector<uchar> spoilTenth(ListCall& list, Random& random)
{
    std::vector<uchar> isWrong;
    for (Point2d& pixel : list.pixels)
    {
        isWrong.push_back(random.uniform(0, 1) < 0.1);
        if (isWrong.back())
            pixel += Point2d(random.uniform(-40, 40), random.uniform(-40, 40));
    }
    return isWrong;
}

//! Of each point, pixels that are right and that are wrong.
std::vector<Vec2i> pixelCounts(const ListCall& list, const std::vector<uchar>& isWrong)
{
    std::vector<Vec2i> counts(list.call.points.size());
    for (size_t i = 0; i < isWrong.size(); i++)
        if (isSeen(list.pixels[i]))
            counts[list.observations[i][2]][isWrong[i]]++;
    return counts;
}

//! One length for all: the longest between points that have two wrong pixels each. Where the fit loses one, nothing tells the scale.
void keepOneLength(const std::vector<Vec2i>& counts, const BundleScene& scene, ListCall& list)
{
    std::vector<int> ends;
    for (int i = 0; i < (int)counts.size(); i++)
        if (counts[i][1] == 2 && counts[i][0] >= 5)
            ends.push_back(i);
    REQUIRE(ends.size() > 1);
    double longest = 0;
    for (int a : ends)
        for (int b : ends)
            if (norm(scene.points[a] - scene.points[b]) > longest)
            {
                longest = norm(scene.points[a] - scene.points[b]);
                list.call.lengths = { Vec4d(a, b, longest, 0.1) };
            }
}

//! What a calibration knows of a camera behind a flat pane.
Mat priorOf(const RefractiveCamera& camera)
{
    const std::vector<std::pair<String, double> > sigmas = { { "f", 0.5 }, { "c", 0.5 }, { "k", 1e-3 }, { "p", 1e-3 },
        { "distance", 0.5 }, { "thickness", 0.05 }, { "outer", 5e-4 } };
    const std::vector<String> names = camera.parameterNames();
    Mat prior = Mat::zeros((int)names.size(), (int)names.size(), CV_64F);
    for (int i = 0; i < prior.rows; i++)
        for (const auto& sigma : sigmas)
            if (names[i].find(sigma.first) == 0)
                prior.at<double>(i, i) = sigma.second*sigma.second;
    const int normal = camera.lensParameters().rows;
    const Vec3d n = camera.window().normal;
    Mat(2e-3*2e-3*(Matx33d::eye() - n*n.t())).copyTo(prior(Rect(normal, normal, 3, 3)));
    return prior;
}

//! The poses of a start. @param off degrees
void moveViews(ListCall& list, Random& random, double off)
{
    for (size_t view = 1; view < list.call.rvecs.size(); view++)
    {
        list.call.rvecs[view] += Mat(random.vector(off*CV_PI/180));
        list.call.tvecs[view] += Mat(random.vector(6*off));
    }
}

void addViews(const ListCall& list, const BundleScene& scene, WrongPixels& all)
{
    for (size_t view = 1; view < scene.rvecs.size(); view++)
    {
        Mat_<double> error(6, 1), solved;
        Mat(list.call.rvecs[view] - Mat(scene.rvecs[view])).copyTo(error.rowRange(0, 3));
        Mat(list.call.tvecs[view] - Mat(scene.tvecs[view])).copyTo(error.rowRange(3, 6));
        const bool isKept = checkRange(error) && solve(list.call.viewCovariances[view], error, solved, DECOMP_CHOLESKY);
        all.lostViews += !isKept;
        all.wrongViews += isKept && error.dot(solved) > 50;     // chi squared of 6: 5e-9
    }
}

void addPixels(const ListCall& list, const std::vector<uchar>& isWrong, WrongPixels& all)
{
    for (size_t i = 0; i < isWrong.size(); i++)
        if (isSeen(list.pixels[i]) && !isWrong[i] && std::isfinite(list.call.points[list.observations[i][2]].x))
        {
            all.good++;
            all.lost += !list.inliers[i];
        }
}

//! @param perView points of a view that the one before does not show. @param off of the start, degrees
WrongPixels fitWrongPixels(int views, int perView, int strips, double off)
{
    const RigTruth truth = makeRig(1, { 0 }, 1.333);
    WrongPixels all;
    for (; all.strips < strips; all.strips++)
    {
        Random random(50 + 100*all.strips);
        const BundleScene scene = makeStrip(truth, views, random, 0.3, perView, 24);
        ListCall list(BundleCall(truth, scene, random, 0));
        list.rigCovariance = priorOf(*truth.cameras[0]);
        moveViews(list, random, off);
        const std::vector<uchar> isWrong = spoilTenth(list, random);
        keepOneLength(pixelCounts(list, isWrong), scene, list);
        const String fault = thrown([&] { list.run(GLASS_ROBUST); });
        UNSCOPED_INFO("strip " << all.strips << ": " << fault);
        if (!fault.empty())
        {
            all.refused++;
            continue;
        }
        addViews(list, scene, all);
        for (int end = 0; end < 2; end++)
            all.lostEnds += !std::isfinite(list.call.points[(int)list.call.lengths[0][end]].x);
        addPixels(list, isWrong, all);
    }
    return all;
}

void checkWrongPixels(int views, int perView, int strips)
{
    CAPTURE(seed());
    for (double off : { 0.02, 0.5 })
    {
        const WrongPixels all = fitWrongPixels(views, perView, strips, off);
        std::cout << "[numbers] strips of " << views << " views, 10 % of the pixels wrong, a start off by " << off << " degrees: "
                  << all.refused << " of " << all.strips << " refused, " << all.lostViews << " views lost, " << all.wrongViews
                  << " wrong, " << all.lostEnds << " ends of lengths lost, " << all.lost << " of " << all.good
                  << " good pixels left out" << std::endl;
        CHECK(all.refused == 0);
        CHECK(all.lostViews == 0);
        CHECK(all.wrongViews == 0);
        CHECK(all.lostEnds == 0);
        const double expected = 1e-4*all.good;
        CHECK(all.lost <= expected + 3*std::sqrt(expected) + 1);
    }
}

} // namespace

TEST_CASE("A strip with a tenth of its pixels wrong keeps views, scale and pixels", "[bundle][sparse][robust]")
{
    checkWrongPixels(10, 25, 3);
}

TEST_CASE("A strip with a tenth of its pixels wrong keeps views, scale and pixels: many strips", "[.monte-carlo]")
{
    checkWrongPixels(20, 40, trials(20));
}

namespace {

//! d(far pose)/d(near pose), where far t = t - R origin, by differences.
Mat farByNear(const Mat& rvec, const Vec3d& origin)
{
    const double STEP = 1e-6;
    Mat derivatives = Mat::eye(6, 6, CV_64F);
    for (int k = 0; k < 3; k++)
    {
        Matx33d sides[2];
        for (int side : { 0, 1 })
        {
            Vec3d turned(rvec.ptr<double>());
            turned[k] += side ? STEP : -STEP;
            Rodrigues(turned, sides[side]);
        }
        Mat(-((sides[1] - sides[0])*origin)*(0.5/STEP)).copyTo(derivatives(Rect(k, 3, 1, 3)));
    }
    return derivatives;
}

} // namespace

TEST_CASE("A scene in survey coordinates is fitted as one whose origin is near", "[bundle][far_origin]")
{
    CAPTURE(seed());
    Random random(31);
    const RigTruth truth = movingPair();
    const BundleScene scene = makeMovingScene(truth, 6, 40, random, 0.1, 0.2);
    for (bool arePosesKnown : { false, true })
    {
        const BundleCall start(truth, scene, random, arePosesKnown ? 0 : 0.5);
        const int flags = GLASS_FREE_DISTANCE | GLASS_FREE_EXTRINSICS | (arePosesKnown ? GLASS_USE_POSES : 0);
        const Mat known = Mat::diag((Mat_<double>(6, 1) << 1e-8, 2e-8, 1e-8, 25, 36, 49));
        ListCall near(start);
        if (arePosesKnown)
            near.call.poseCovariances.assign(6, known);
        const double rms = near.run(flags);
        for (double away : { 1e4, 1e6, 1e8 })           // of 600 mm to the scene
        {
            if (arePosesKnown && away > 1e6)            // a covariance about so far an origin has no digits left
                continue;
            CAPTURE(arePosesKnown, away);
            const Vec3d origin = away*normalize(Vec3d(1, 0.5, 0.2));
            ListCall far(start);
            for (size_t view = 0; view < far.call.tvecs.size(); view++)
            {
                Matx33d R;
                Rodrigues(far.call.rvecs[view], R);
                far.call.tvecs[view] = far.call.tvecs[view] - Mat(R*origin);
                if (!arePosesKnown)
                    continue;
                const Mat moved = farByNear(far.call.rvecs[view], origin);
                far.call.poseCovariances.push_back(moved*known*moved.t());
            }
            CHECK(std::abs(far.run(flags) - rms) < 1e-7*rms);
            const double rounding = 1e-7 + 1e-15*away, relative = 1e-5 + 1e-11*away;    // of covariances that are given
            CHECK(norm(far.call.cameras[0]->window().normal - near.call.cameras[0]->window().normal) < relative*1e-3);
            CHECK(largestDifference(far.call.stdDeviations, near.call.stdDeviations) < relative*norm(near.call.stdDeviations));
            CHECK(largestDifference(far.call.pointDeviations, near.call.pointDeviations) < relative*norm(near.call.pointDeviations));
            for (size_t i = 0; i < scene.points.size(); i++)
                CHECK(norm(far.call.points[i] - Point3d(origin) - near.call.points[i]) < (arePosesKnown ? relative : rounding));
            for (size_t view = 1; view < scene.rvecs.size(); view++)
            {
                const Mat moved = farByNear(near.call.rvecs[view], origin);
                const Mat expected = moved*near.call.viewCovariances[view]*moved.t();
                CHECK(norm(far.call.viewCovariances[view], expected) < 1e-5*norm(expected));
            }
        }
    }
}
