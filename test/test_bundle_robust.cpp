// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The robust bundle adjustment: what it leaves out of clean data, what it states, and what it does with points that are wrong.
#include "bundle_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const double WATER = 1.333, SIGMA = 0.3;        // px

RigTruth standingRig(int cameras)
{
    std::vector<int> windows;
    for (int c = 0; c < cameras; c++)
        windows.push_back(c);
    return makeRig(cameras, windows, WATER, 0.25);
}

//! What a robust fit made of data sets of one kind.
struct Tally
{
    int sets = 0, refused = 0, observations = 0, leftOut = 0;
    //! Of the normals' errors over their sigmas, robust and plain; of robust sigmas over plain ones.
    double squares = 0, plainSquares = 0, stated = 0;
    int normals = 0;

    double leftOutPart() const { return (double)leftOut/std::max(observations, 1); }
    double errorOverStated() const { return std::sqrt(squares/std::max(normals, 1)); }
    double plainErrorOverStated() const { return std::sqrt(plainSquares/std::max(normals, 1)); }
    double statedOverPlain() const { return stated/std::max(normals, 1); }
};

void addNormals(const BundleCall& robust, const BundleCall& plain, const RigTruth& truth, Tally& tally)
{
    for (size_t c = 0; c < truth.cameras.size(); c++)
    {
        const Vec3d normal = truth.cameras[c]->window().normal;
        const int first = 16*(int)c + 8;        // 16 parameters each, 8 of the lens
        const Mat tangents(tangentsOf(normal)), error = tangents.t()*Mat(robust.cameras[c]->window().normal - normal);
        const Mat plainError = tangents.t()*Mat(plain.cameras[c]->window().normal - normal);
        const Mat stated = tangents.t()*robust.covariance(Rect(first, first, 3, 3))*tangents;
        const Mat without = tangents.t()*plain.covariance(Rect(first, first, 3, 3))*tangents;
        for (int i = 0; i < 2; i++)
        {
            tally.squares += std::pow(error.at<double>(i), 2)/stated.at<double>(i, i);
            tally.plainSquares += std::pow(plainError.at<double>(i), 2)/without.at<double>(i, i);
            tally.stated += std::sqrt(stated.at<double>(i, i)/without.at<double>(i, i));
            tally.normals++;
        }
    }
}

//! Fits clean data from the truth, robustly and not.
void addClean(const RigTruth& truth, const BundleScene& scene, Random& random, int flags, Tally& tally)
{
    tally.sets++;
    BundleCall plain(truth, scene, random, 0), robust(truth, scene, random, 0);
    plain.run(flags);
    try
    {
        robust.run(flags | GLASS_ROBUST);
    }
    catch (const cv::Exception& e)
    {
        UNSCOPED_INFO(e.what());
        tally.refused++;
        return;
    }
    addNormals(robust, plain, truth, tally);
    for (size_t i = 0; i < plain.inliers.size(); i++)
    {
        tally.observations += countNonZero(plain.inliers[i]);
        tally.leftOut += countNonZero(plain.inliers[i] & ~robust.inliers[i]);
    }
}

Tally cleanWands(int cameras, int moments, int flags, int sets, int salt)
{
    const RigTruth truth = standingRig(cameras);
    Tally tally;
    for (int set = 0; set < sets; set++)
    {
        Random random(salt + set);
        addClean(truth, makeWandScene(truth, moments, random, SIGMA), random, GLASS_FREE_EXTRINSICS | flags, tally);
    }
    return tally;
}

Tally cleanMoving(int views, int points, int sets, int salt)
{
    const RigTruth truth = standingRig(1);
    Tally tally;
    for (int set = 0; set < sets; set++)
    {
        Random random(salt + set);
        addClean(truth, makeMovingScene(truth, views, points, random, SIGMA), random, 0, tally);
    }
    return tally;
}

void print(const String& what, const Tally& t)
{
    std::cout << "[numbers] " << what << ": " << t.refused << " of " << t.sets << " refused, left out " << t.leftOut << " of "
              << t.observations << " (" << t.leftOutPart() << "), normal's error/stated " << t.errorOverStated()
              << " (plain fit " << t.plainErrorOverStated()
              << "), stated/that of the plain fit " << t.statedOverPlain() << std::endl;
}

/** A chance of 1e-4 for each observation; where three cameras see a wand, all six observations of its ends go with one. Three
times the scatter is allowed. Where some went, the errors of few sets differ by chance. */
void checkClean(const Tally& t)
{
    CAPTURE(t.leftOut, t.observations);
    CHECK(t.refused == 0);
    const double expected = 3e-4*t.observations;
    CHECK(t.leftOut <= expected + 3*std::sqrt(6*expected) + 6);
    CHECK(t.statedOverPlain() == Approx(1).margin(0.05));
    if (t.leftOut == 0 || t.sets >= 20)
        CHECK(t.errorOverStated() == Approx(t.plainErrorOverStated()).margin(0.05));
}

void checkCleanData(int sets)
{
    CAPTURE(seed(), sets);
    for (int moments : { 15, 40, 100 })
        for (int flags : { 0, (int)GLASS_FREE_DISTANCE })
        {
            CAPTURE(moments, flags);
            const Tally t = cleanWands(2, moments, flags, sets, 41000);
            print(format("a wand at %d moments before 2 cameras%s", moments, flags ? ", distances free" : ""), t);
            checkClean(t);
        }
    for (int moments : { 15, 40 })
    {
        CAPTURE(moments);
        const Tally t = cleanWands(3, moments, 0, sets, 42000);
        print(format("a wand at %d moments before 3 cameras", moments), t);
        checkClean(t);
    }
    const Tally t = cleanMoving(3, 60, sets, 43000);
    print("60 points in 3 views of one camera", t);
    checkClean(t);
}

//! Somewhere else in every image, each by its own.
void spoil(int point, double least, double most, size_t images, Random& random, BundleScene& scene)
{
    size_t left = images;
    for (PixelViews& views : scene.pixels)
        for (std::vector<Point2d>& pixels : views)
            if (left > 0 && !std::isnan(pixels[point].x))
            {
                const double angle = random.uniform(0, 2*CV_PI);
                pixels[point] += random.uniform(least, most)*Point2d(std::cos(angle), std::sin(angle));
                left--;
            }
}

//! Error of the distance between two points over its stated deviation, as if the points' own were independent.
double scaleError(const BundleCall& call, const BundleScene& scene)
{
    double found = 0, right = 0;
    int count = 0;
    for (size_t i = 2; i + 1 < scene.points.size(); i++)
        if (std::isfinite(call.points[i].x) && std::isfinite(call.points[i + 1].x))
        {
            found += norm(call.points[i] - call.points[i + 1]);
            right += norm(scene.points[i] - scene.points[i + 1]);
            count++;
        }
    return count == 0 ? INF : std::abs(std::log(found/right));
}

//! The relative scale that point deviations state: of a far point, over its distance.
double statedScale(const BundleCall& call)
{
    double sum = 0;
    int count = 0;
    for (size_t i = 2; i < call.points.size(); i++)
        if (std::isfinite(call.points[i].x))
        {
            const Mat row = call.pointDeviations.row((int)i);
            sum += norm(row)/norm(call.points[i]);
            count++;
        }
    return sum/count;
}

struct LostLength
{
    int sets = 0, refused = 0, wrong = 0;
};

/** The only known length ends at a point that is wrong in all images: refused, or as uncertain as it is wrong.
@param cameras one: it moves */
LostLength loseLength(int cameras, int views, int sets, int salt)
{
    const RigTruth truth = standingRig(cameras);
    LostLength result;
    for (int set = 0; set < sets; set++, result.sets++)
    {
        Random random(salt + set);
        BundleScene scene = makeMovingScene(truth, views, 60, random, SIGMA);
        spoil(0, 10, 60, 1000, random, scene);
        BundleCall call(truth, scene, random, 0);
        try
        {
            call.run((cameras > 1 ? GLASS_FREE_EXTRINSICS : 0) | GLASS_ROBUST);
        }
        catch (const cv::Exception&)
        {
            result.refused++;
            continue;
        }
        const double error = scaleError(call, scene), stated = statedScale(call);
        UNSCOPED_INFO("scale off by " << error << ", stated " << stated << ", point 0 at " << call.points[0]);
        result.wrong += error > 5*stated;
    }
    return result;
}

void checkLostLength(int sets)
{
    CAPTURE(seed(), sets);
    for (const auto& rig : { std::make_pair(1, 4), std::make_pair(1, 6), std::make_pair(2, 3), std::make_pair(3, 1) })
    {
        const LostLength lost = loseLength(rig.first, rig.second, sets, 44000);
        std::cout << "[numbers] the only length lost, cameras " << rig.first << ", views " << rig.second << ": " << lost.refused
                  << " of " << lost.sets << " refused, " << lost.wrong << " wrong" << std::endl;
        CHECK(lost.wrong == 0);
    }
}

//! Points of which most of 8 observations are wrong; how many of them are kept and off by more than 5 sigma.
void checkContradicted(int sets)
{
    CAPTURE(seed(), sets);
    const RigTruth truth = standingRig(2);
    int wrong = 0, kept = 0, spoilt = 0, good = 0, lost = 0;
    for (int set = 0; set < sets; set++)
    {
        Random random(45000 + set);
        BundleScene scene = makeMovingScene(truth, 4, 60, random, SIGMA);
        for (int i = 10; i < 16; i++)
            spoil(i, 10, 60, i < 13 ? 6 : 7, random, scene);
        BundleCall call(truth, scene, random, 0);
        call.run(GLASS_FREE_EXTRINSICS | GLASS_ROBUST);
        for (int i = 0; i < 60; i++)
        {
            const bool isFound = std::isfinite(call.points[i].x);
            if (i < 10 || i >= 16)
            {
                good++;
                lost += !isFound;
                continue;
            }
            spoilt++;
            kept += isFound;
            wrong += isFound && norm(call.points[i] - scene.points[i]) > 5*norm(call.pointDeviations.row(i));
        }
    }
    std::cout << "[numbers] points with 6 or 7 of 8 observations wrong: " << kept << " of " << spoilt << " kept, " << wrong
              << " of them wrong; of others " << lost << " of " << good << " lost" << std::endl;
    CHECK(kept == 0);
    CHECK(lost <= 3 + 5e-4*good);
}

} // namespace

TEST_CASE("A robust bundle adjustment loses nothing of clean data", "[bundle][robust]") { checkCleanData(4); }
TEST_CASE("A robust bundle adjustment loses nothing of clean data: many sets", "[.monte-carlo]") { checkCleanData(trials(40)); }

TEST_CASE("A length that is lost with its end is not stated", "[bundle][robust]") { checkLostLength(3); }
TEST_CASE("A length that is lost with its end is not stated: many sets", "[.monte-carlo]") { checkLostLength(trials(40)); }

TEST_CASE("A point that most of its observations contradict is left out", "[bundle][robust]") { checkContradicted(2); }
TEST_CASE("A point that most of its observations contradict is left out: many sets", "[.monte-carlo]")
{
    checkContradicted(trials(30));
}

TEST_CASE("Pixels that are of other points fit no start, and that is the reason that is told", "[bundle][robust]")
{
    for (int cameras : {2, 3})
        for (double sigma : {0., SIGMA})
        {
            Random random(45900 + cameras);
            CAPTURE(seed(), cameras, sigma);
            const RigTruth truth = standingRig(cameras);
            BundleScene scene = makeWandScene(truth, 60, random, sigma);
            std::reverse(scene.pixels[1][0].begin(), scene.pixels[1][0].end());
            BundleCall call(truth, scene, random);
            const cv::Vec3d before = call.cameras[1]->window().normal;
            try
            {
                call.run(GLASS_FREE_EXTRINSICS | GLASS_ROBUST);
                FAIL("a fit with " << call.rms << " px");
            }
            catch (const cv::refract::CalibrationError& e)
            {
                CAPTURE(e.err);
                CHECK(e.cause == cv::refract::CalibrationError::TOO_FEW_INLIERS);
            }
            CHECK(call.cameras[1]->window().normal == before);
        }
}

TEST_CASE("Cameras that tell halves of pixels alone serve a robust bundle adjustment", "[bundle][robust]")
{
    CAPTURE(seed());
    Random random(45950);
    const RigTruth truth = standingRig(3);
    BundleScene scene = makeWandScene(truth, 60, random, SIGMA);
    for (int c : {1, 2})
        for (cv::Point2d& pixel : scene.pixels[c][0])
            (c == 1 ? pixel.y : pixel.x) = NaN;
    BundleCall call(truth, scene, random, 0);
    CHECK(call.run(GLASS_FREE_EXTRINSICS | GLASS_ROBUST) < 2*SIGMA);
}
