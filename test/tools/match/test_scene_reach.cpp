// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

/* What checks by a scene reach: changes x media, from many rigs. Matches are drawn, with the errors that matches of rendered images have
(drawn_matches.hpp); tests of rendered images are beside this. */
#include "drawn_matches.hpp"
#include "assess/rig_check.hpp"
#include "bundle/bundle_adjustment.hpp"
#include "match/moved_rig.hpp"
#include "match/scene_check.hpp"
#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <iostream>
#include <map>

using namespace match_scene;

namespace {

const double FALSE_ALARM = 0.01, SHOWN = 0.1, CERTAIN = 0.95;       // SHOWN: degrees, of the power

//! What is seen.
struct Seen
{
    int moments = 20, count = 3000;
    bool isWall = false;                        //!< and nothing before it
    double moving = 0;                          //!< share of the image's width: things that moved between the images of a pair, px below
    int reflected = 0;                          //!< features of a reflection on the pane, at the same place in all images
};

//! Something that became of a rig, and what it should be called.
struct Happened
{
    std::string text;
    std::string name;                           //!< begins the right one; empty: nothing happened
    std::function<void(Rig&)> apply;
    int axis = -1;                              //!< of a turn: about which
    double degrees = 0;
    Seen seen = {};
    bool isInAir = true;
};

const char TURNED_2[] = "R of camera 2 (turned about its own centre)", TURNED_1[] = "R of camera 2 alone (T as it was: camera 1 turned";

Happened turned(int camera, double degrees, int axis)
{
    Vec3d about;
    about[axis] = degrees*DEGREE;
    return { cv::format("camera %d turned by %.2f deg about %c", camera + 1, degrees, "xyz"[axis]), camera ? TURNED_2 : TURNED_1,
             [=](Rig& rig) { rig.turnCamera(camera, about); }, axis, degrees };
}

void tiltPane(Rig& rig, int c, double degrees)
{
    GlassWindow window = rig.truth.cameras[c]->window();
    const double azimuth = rig.random.uniform(0, 2*CV_PI);
    const Vec3d across = cv::normalize(window.normal.cross(Vec3d(0, 1, 0)));
    window.normal = cv::normalize(window.normal + std::tan(degrees*DEGREE)*(std::cos(azimuth)*across
                                                                            + std::sin(azimuth)*window.normal.cross(across)));
    rig.truth.cameras[c]->setWindow(window);
}

void warmWater(Rig& rig, double byIndex)
{
    for (const auto& camera : rig.truth.cameras)
    {
        GlassWindow window = camera->window();
        window.outerIndex += byIndex;
        camera->setWindow(window);
    }
}

std::vector<Happened> whatHappened()
{
    const double WARMER = -0.0009;      // of water, from 20 to 28 degrees C
    const auto nothing = [](Rig&) {};
    std::vector<Happened> all = { { "nothing", "", nothing, -1, 0, { 5, 1000 } } };
    for (const double degrees : { 0.02, 0.05 })
        for (const int axis : { 0, 1 })
            all.push_back(turned(1, degrees, axis));
    all.push_back(turned(0, 0.05, 0));
    all.push_back({ "principal point of camera 2 moved by 2 px", "principal point of camera 2", [](Rig& rig) {
        cv::Mat lens = rig.truth.cameras[1]->lensParameters().clone();
        lens.at<double>(3) += 2;
        rig.truth.cameras[1]->setLensParameters(lens); } });
    all.push_back({ "pane 2 turned by 0.3 deg", "window of camera 2 tilted", [](Rig& rig) { tiltPane(rig, 1, 0.3); }, -1, 0, {}, false });
    all.push_back({ "water warmer by 8 K", "index of the medium", [=](Rig& rig) { warmWater(rig, WARMER); }, -1, 0, {}, false });
    all.push_back({ "nothing; a third of the image moves", "", nothing, -1, 0, { 20, 3000, false, 0.33 } });
    all.push_back({ "nothing; a reflection at a fixed place", "", nothing, -1, 0, { 20, 3000, false, 0, 80 } });
    all.push_back({ "nothing; one pair", "", nothing, -1, 0, { 1, 1500 } });
    all.push_back({ "nothing; a plain wall, one pair", "", nothing, -1, 0, { 1, 1500, true } });
    all.push_back({ "nothing; night, one pair", "", nothing, -1, 0, { 1, 30 } });
    return all;
}

FeatureNoise measuredNoise(double outerIndex)
{
    FeatureNoise noise;
    for (int i = 0; i < 2; i++)
    {
        Rig rig(4700 + i, outerIndex);
        const TexturedScene room = roomOf(rig.random);
        SceneOptions options;
        options.depth = DEPTH;
        const SceneMatcher matcher(rig.calibration, options);
        const ScaledMatches all = matcher.matchesOf("room", render(room, rig.truth, usualExposure(), i));
        addNoise(room, rig.truth, all, matcher.goodOf(all), noise);
    }
    return noise;
}

TexturedScene wallOf(scenes::Random& random)
{
    TexturedScene wall;
    const Vec3d normal(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), -1);
    wall.surfaces.push_back(std::make_shared<Plane>(Vec3d(0, 0, 900), cv::normalize(normal), Vec3d(1, 1, 1)));
    return wall;
}

ScaledMatches drawSeen(Rig& rig, const Seen& seen, const FeatureNoise& noise)
{
    const double MOVED = 5, BESIDE = 4;         // px
    ScaledMatches all, reflection;
    if (seen.reflected > 0)
        reflection = drawMatches("", roomOf(rig.random), rig.truth, noise, seen.reflected, rig.random);
    const double beside = rig.random.uniform(-BESIDE, BESIDE);
    for (int m = 0; m < seen.moments; m++)
    {
        ScaledMatches ofMoment = drawMatches(std::to_string(m), seen.isWall ? wallOf(rig.random) : roomOf(rig.random), rig.truth, noise,
                                             seen.count/seen.moments, rig.random);
        const Point2d moved(rig.random.uniform(-MOVED, MOVED), rig.random.uniform(-MOVED, MOVED));
        for (int i = 0; i < ofMoment.size(); i++)
            if (ofMoment.matches.pixels[0][i].x < seen.moving*rig.truth.cameras[0]->imageSize().width)
                ofMoment.matches.pixels[1][i] += moved;
        all.add(ofMoment);
        for (int i = 0; i < reflection.size(); i++)
            reflection.matches.names[i].image = std::to_string(m);
        ScaledMatches here = reflection;
        for (int i = 0; i < here.size(); i++)
            here.matches.pixels[1][i] += Point2d(rig.random.normal(0.1), beside + rig.random.normal(0.1));
        if (here.size() > 0)
            all.add(here);
    }
    return all;
}

struct Reached
{
    int trials = 0, changed = 0, cannotTell = 0, named = 0, first = 0;
    double least = 1, seconds = 0;              //!< power
    cv::Vec3d squares;                          //!< of errors over stated: about each axis
    double ofLength = 0;                        //!< the same of the angle as a length
    double residual = 0, ignored = 0;           //!< px^2; of the first rig alone, as it costs a fit more
    std::vector<int> count;                     //!< of names
    std::map<std::string, int> firsts;

    void add(const Happened& happened, const CheckResult& result)
    {
        trials++;
        changed += result.changed;
        double power = 1;
        for (const TurnCheck& turn : result.turns)
            power = std::min(power, powerOf(turn, result, SHOWN));
        least = std::min(least, power);
        cannotTell += !result.changed && power < CERTAIN;
        const auto isRight = [&](const NamedChange& c) { return !happened.name.empty() && c.name.find(happened.name) == 0; };
        const auto right = std::find_if(result.changes.begin(), result.changes.end(), isRight);
        if (!result.changes.empty())
        {
            first += right == result.changes.begin();
            firsts[result.changes[0].name]++;
            count.push_back((int)result.changes.size());
        }
        if (right == result.changes.end())
            return;
        named++;
        if (happened.axis < 0)
            return;
        const ChangedValue& value = right->values[0];
        for (int i = 0; i < 3; i++)
        {
            const ValueAboutAxis& about = value.aboutAxes[i];
            squares[i] += std::pow((about.value - (i == happened.axis ? happened.degrees : 0))/about.std, 2);
        }
        ofLength += std::pow((value.value - happened.degrees)/value.std, 2);
    }

    void print(const Happened& happened)
    {
        std::sort(count.begin(), count.end());
        std::cout << cv::format("[numbers] %s: changed %d of %d, cannot tell %d (least power %.2f)", happened.text.c_str(), changed, trials,
                                cannotTell, least);
        if (!happened.name.empty())
            std::cout << cv::format("; named %d, first %d, names (median) %d", named, first, count.empty() ? 0 : count[count.size()/2]);
        if (happened.axis >= 0 && named)
            std::cout << cv::format("; error over stated about x %.2f, y %.2f, z %.2f, of the length %.2f", std::sqrt(squares[0]/named),
                                    std::sqrt(squares[1]/named), std::sqrt(squares[2]/named), std::sqrt(ofLength/named));
        std::cout << cv::format("; residuals %.3f px, glass ignored %.3f px; %.2f s of a processor a check\n", std::sqrt(residual/trials),
                                std::sqrt(ignored), seconds/trials);
        for (const auto& name : firsts)
            std::cout << cv::format("              first %d x %s\n", name.second, name.first.c_str());
    }
};

SceneMatcher matcherOf(const Calibration& calibration)
{
    SceneOptions options;
    options.depth = DEPTH;
    return SceneMatcher(calibration, options);
}

void check(const Happened& happened, double outerIndex, int trial, const FeatureNoise& noise, Reached& reached)
{
    Rig rig(9000 + trial, outerIndex, 2);
    happened.apply(rig);
    const ScaledMatches all = drawSeen(rig, happened.seen, noise);
    const SceneMatches matches = matcherOf(rig.calibration).goodOf(all);
    CheckInput input = checkInputOf(rig.calibration, "", 0);
    input.sigma = matches.good.matches.usualStd();
    const std::clock_t start = std::clock();            // other programs count for nothing
    const CheckResult result = checkScene(input, observationsOf(input.rig, matches.good.matches), FALSE_ALARM, "mm");
    reached.seconds += (double)(std::clock() - start)/CLOCKS_PER_SEC;
    reached.residual += matches.residual*matches.residual;
    if (trial == 0)
        reached.ignored = std::pow(residualWithoutWindows(rig.calibration, matches.good), 2);
    reached.add(happened, result);
    for (size_t i = 0; std::getenv("VERBOSE") && i < result.changes.size(); i++)
        std::cout << (i ? "      or " : "    ") << result.changes[i].sentence << '\n';
}

//! A check by some moments of a room, of an exact calibration that is said to be known well, of which camera 2 has turned since.
CheckResult checkOfTurned(unsigned salt, const Vec3d& degrees, double sigma, double share)
{
    Rig rig(salt);
    rig.truth = modelOf(rig.calibration);
    rig.calibration.covariance *= share;
    rig.turnCamera(1, DEGREE*degrees);
    const FeatureNoise noise{ { sigma, 0 }, 0, 0, { { 1, 1 } } };
    const SceneMatches matches = matcherOf(rig.calibration).goodOf(drawSeen(rig, { 4, 800 }, noise));
    CheckInput input = checkInputOf(rig.calibration, "", 0);
    input.sigma = matches.good.matches.usualStd();
    return checkScene(input, observationsOf(input.rig, matches.good.matches), FALSE_ALARM, "mm");
}

} // namespace

TEST_CASE("A turn that a calibration contradicts by far leaves the noise of a scene, and every +-, as they are", "[tools][match][check]")
{
    const double SIGMA = 0.05, TURN = 0.1;
    const CheckResult result = checkOfTurned(471, Vec3d(TURN, 0, 0), SIGMA, 0.01), unchanged = checkOfTurned(471, Vec3d(), SIGMA, 0.01);
    INFO(causesIn(result));
    CHECK(!unchanged.changed);
    CHECK(result.sigma == Approx(SIGMA).epsilon(0.1));
    REQUIRE(!result.changes.empty());
    CHECK(result.changes[0].name.find(TURNED_2) == 0);
    const ValueAboutAxis& about = result.changes[0].values[0].aboutAxes[0];
    CHECK(std::abs(about.value - TURN) < 4*about.std);
    CHECK(result.turns[0].stdDeg < 1.3*unchanged.turns[0].stdDeg);
}

TEST_CASE("A part of an image that moved by less than one match shows is left out as a whole", "[tools][match]")
{
    const double SIGMA = 0.05, MOVED = 3*SIGMA;
    Rig rig(478);
    const FeatureNoise noise{ { SIGMA, 0 }, 0, 0, { { 1, 1 } } };
    ScaledMatches all = drawSeen(rig, { 4, 1200 }, noise);
    const auto moves = [](const Matches& m, int i) {
        return m.names[i].image == "0" && m.pixels[0][i].x < SIZE.width/4. && m.pixels[0][i].y < SIZE.height/2.; };
    int moving = 0, left = 0;
    for (int i = 0; i < all.size(); i++)
        if (moves(all.matches, i))
        {
            all.matches.pixels[1][i].y += MOVED;
            moving++;
        }
    const Matches good = matcherOf(rig.calibration).goodOf(all).good.matches;
    for (int i = 0; i < (int)good.names.size(); i++)
        left += moves(good, i);
    CHECK(moving > 20);
    CHECK(left < 0.2*moving);
    CHECK((int)good.names.size() - left > 0.9*(all.size() - moving));
}

TEST_CASE("What moves most easily is told first of what explains a scene as well", "[tools][match][check]")
{
    for (unsigned salt = 472; salt < 478; salt++)
    {
        const CheckResult result = checkOfTurned(salt, salt % 2 ? Vec3d(0.02, 0, 0) : Vec3d(0, 0.06, 0), 0.05, 1);
        INFO(salt << ' ' << causesIn(result));
        REQUIRE(!result.changes.empty());
        CHECK(result.changes[0].name.find(TURNED_2) == 0);
    }
}

// TRIALS=200 refract_tools_tests "[scene-table]"; ONLY=nothing takes the rows that begin so
TEST_CASE("The table of what checks by a scene reach", "[tools][.monte-carlo][scene-table]")
{
    const int trials = scenes::trials(10);
    const char* only = std::getenv("ONLY");
    for (const double outerIndex : { 1., 1.333 })
    {
        const FeatureNoise noise = measuredNoise(outerIndex);
        std::cout << cv::format("[numbers] %s; errors of rendered features: sqrt(%.3f^2 + (%.3f s)^2) px, along the curve %.3f px more; "
                                "wrong %.2f %%\n", outerIndex > 1 ? "in water" : "in air", noise.noise.floor, noise.noise.share,
                                noise.alongMore, 100*noise.wrongShare);
        for (const Happened& happened : whatHappened())
        {
            if ((outerIndex <= 1 && !happened.isInAir) || (only && happened.text.find(only) != 0))
                continue;
            Reached reached;
            for (int trial = 0; trial < trials; trial++)
                check(happened, outerIndex, trial, noise, reached);
            reached.print(happened);
            std::cout << std::flush;
            if (happened.name.empty())
                CHECK(reached.changed <= 2 + 3*trials*FALSE_ALARM);
            else
                CHECK(reached.named >= 0.9*reached.changed);
        }
    }
}

namespace {

//! Points that both cameras see, as they are and as measured.
struct Measured
{
    double squares = 0, overStated = 0;
    int count = 0;

    void add(const Rig& rig, const Calibration& calibration, scenes::Random& random)
    {
        const double NOISE = 0.05;
        const FeatureNoise exact{ {}, 0, 0, { { 1, 1 } } };
        const ScaledMatches drawn = drawMatches("", roomOf(random), rig.truth, exact, 100, random);
        RigPixels pixels = drawn.matches.pixels;
        const std::vector<Point3d> truth = triangulate(rig.truth, pixels);
        for (std::vector<Point2d>& ofCamera : pixels)
            for (Point2d& p : ofCamera)
                p += Point2d(random.normal(NOISE), random.normal(NOISE));
        const Measurement measured = measureRig(calibration, pixels, NOISE);
        for (size_t i = 0; i < truth.size(); i++)
            if (measured.points[i].x == measured.points[i].x)
            {
                const Vec3d error = Vec3d(measured.points[i]) - Vec3d(truth[i]);
                squares += error.dot(error);
                for (int k = 0; k < 3; k++)
                    overStated += error[k]*error[k]/(measured.sigma[i][k]*measured.sigma[i][k])/3;
                count++;
            }
    }
    double rms() const { return std::sqrt(squares/count); }
    double ratio() const { return std::sqrt(overStated/count); }
};

} // namespace

// TRIALS=50 refract_tools_tests "[scene-again]"
TEST_CASE("A rig of which a camera turned, calibrated again by a scene", "[tools][.monte-carlo][scene-again]")
{
    const int trials = scenes::trials(20);
    const double TURN = 0.3;
    for (const double outerIndex : { 1., 1.333 })
    {
        const FeatureNoise noise = measuredNoise(outerIndex);
        Measured fresh, again, asItWas;
        for (int trial = 0; trial < trials; trial++)
        {
            Rig rig(9500 + trial, outerIndex, 2);
            fresh.add(rig, rig.calibration, rig.random);
            Vec3d axis(rig.random.normal(1), rig.random.normal(1), rig.random.normal(1));
            rig.turnCamera(1, TURN*DEGREE*cv::normalize(axis));
            const SceneMatches matches = matcherOf(rig.calibration).goodOf(drawSeen(rig, {}, noise));
            const CheckInput input{ modelOf(rig.calibration), rig.calibration.covariance, 0, 0 };
            const BundleStart start{ input.rig, GLASS_FIX_NORMAL, covarianceOfMoved(input, { TURN, 0 }), {} };
            again.add(rig, toFile(adjustBundle(start, matches.good.matches, {}, true), rig.calibration), rig.random);
            asItWas.add(rig, rig.calibration, rig.random);
        }
        std::cout << cv::format("[numbers] %s, camera 2 turned by %.1f deg, %d rigs: error of points over stated %.2f; RMS %.3f mm, with a "
                                "fresh calibration by boards %.3f mm (over stated %.2f), with the calibration as it was %.3f mm\n",
                                outerIndex > 1 ? "in water" : "in air", TURN, trials, again.ratio(), again.rms(), fresh.rms(),
                                fresh.ratio(), asItWas.rms());
        CHECK(again.rms() < 1.5*fresh.rms());
        CHECK(again.ratio() < 1.3);
    }
}
