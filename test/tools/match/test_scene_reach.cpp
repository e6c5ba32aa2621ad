// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

/* What checks by a scene reach: changes x media, from many rigs. Matches are drawn, with the errors that matches of rendered images have
(drawn_matches.hpp); tests of rendered images are beside this. */
#include "drawn_matches.hpp"
#include "assess/rig_check.hpp"
#include "bundle/bundle_adjustment.hpp"
#include "match/moved_rig.hpp"
#include "match/scene_matches.hpp"
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
    for (const Seen& seen : { Seen{ 1, 1500, true }, Seen{ 1, 100, false }, Seen{ 1, 30, false } })
        for (const int axis : { 0, 1 })
        {
            Happened shown = turned(1, SHOWN, axis);
            shown.text = cv::format("shown; %s, %d matches of one pair; ", seen.isWall ? "a plain wall" : "a room", seen.count)
                         + shown.text;
            shown.seen = seen;
            all.push_back(shown);
        }
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

struct Reached
{
    int trials = 0, changed = 0, cannotTell = 0, named = 0, first = 0, either = 0;     //!< either: "camera 1 or camera 2 turned"
    double least = 1, mean = 0, seconds = 0;    //!< power
    cv::Vec3d squares;                          //!< of errors over stated: about each axis
    double ofLength = 0;                        //!< the same of the angle as a length
    double residual = 0, ignored = 0;           //!< px^2; of the first rig alone, as it costs a fit more
    std::vector<int> count;                     //!< of names
    std::map<std::string, int> firsts;

    void add(const Happened& happened, const CheckResult& result)
    {
        trials++;
        changed += result.changed;
        double power = result.turns.empty() ? 0 : 1;
        for (const TurnCheck& turn : result.turns)
            power = std::min(power, powerOf(turn, result, SHOWN));
        least = std::min(least, power);
        mean += power;
        cannotTell += !result.changed && power < CERTAIN;
        const auto isRight = [&](const NamedChange& c) { return !happened.name.empty() && c.name.find(happened.name) == 0; };
        const auto right = std::find_if(result.changes.begin(), result.changes.end(), isRight);
        if (!result.changes.empty())
        {
            const size_t alike = std::max<size_t>(1, result.mayHaveTurned.size());      // told in one breath
            first += right != result.changes.end() && right < result.changes.begin() + alike;
            either += alike > 1;
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
        std::cout << cv::format("[numbers] %s: changed %d of %d, cannot tell %d (power: least %.2f, mean %.2f)", happened.text.c_str(),
                                changed, trials, cannotTell, least, mean/trials);
        if (!happened.name.empty())
            std::cout << cv::format("; named %d, first %d (either camera: %d), names (median) %d", named, first, either,
                                    count.empty() ? 0 : count[count.size()/2]);
        if (happened.axis >= 0 && named)
            std::cout << cv::format("; error over stated about x %.2f, y %.2f, z %.2f, of the length %.2f", std::sqrt(squares[0]/named),
                                    std::sqrt(squares[1]/named), std::sqrt(squares[2]/named), std::sqrt(ofLength/named));
        std::cout << cv::format("; residuals %.3f px, glass ignored %.3f px; %.2f s of a processor a check\n", std::sqrt(residual/trials),
                                std::sqrt(ignored), seconds/trials);
        for (const auto& name : firsts)
            std::cout << cv::format("              first %d x %s\n", name.second, name.first.c_str());
    }
};

//! @param row of the table: each has its own rigs
void check(const Happened& happened, double outerIndex, int row, int trial, const FeatureNoise& noise, Reached& reached)
{
    const int MOST_TRIALS = 10000;
    Rig rig(9000 + MOST_TRIALS*row + trial, outerIndex, 2);
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
    const FeatureNoise noise{ { sigma }, 0, 0, { { 1, 1 } } };
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

TEST_CASE("A turn about the base line is said to be one of either camera", "[tools][match][check]")
{
    const CheckResult either = checkOfTurned(487, Vec3d(0.05, 0, 0), 0.05, 1);
    INFO(causesIn(either));
    REQUIRE(either.mayHaveTurned.size() == 2);
    CHECK(causesIn(either).find("camera 1 or camera 2 turned, and these images do not tell which: ") == 0);
    CHECK(either.changes[0].name.find(TURNED_2) == 0);
    CHECK(either.changes[1].name.find(TURNED_1) == 0);
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
        std::cout << cv::format("[numbers] %s; errors of rendered features: sqrt(%.3f^2 + (%.3f^2 + %.3f^2 d) s^2) px, along the curve "
                                "%.3f px more; wrong %.2f %%\n", outerIndex > 1 ? "in water" : "in air", noise.noise.floor,
                                noise.noise.share, noise.noise.unlikeShare, noise.alongMore, 100*noise.wrongShare);
        int row = outerIndex > 1 ? 100 : 0;
        for (const Happened& happened : whatHappened())
        {
            row++;
            if ((outerIndex <= 1 && !happened.isInAir) || (only && happened.text.find(only) != 0))
                continue;
            Reached reached;
            for (int trial = 0; trial < trials; trial++)
                check(happened, outerIndex, row, trial, noise, reached);
            reached.print(happened);
            std::cout << std::flush;
            if (happened.name.empty())
                CHECK(reached.changed <= 2 + 3*trials*FALSE_ALARM);
            else if (happened.seen.moments > 1)
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
    SceneOptions options;
    options.depth = DEPTH;
    options.count = 10000;              // as refract_match takes them
    for (const double outerIndex : { 1., 1.333 })
    {
        const FeatureNoise noise = measuredNoise(outerIndex);
        Measured fresh, either, named, asItWas;
        for (int trial = 0; trial < trials; trial++)
        {
            Rig rig(9500 + trial, outerIndex, 2);
            fresh.add(rig, rig.calibration, rig.random);
            Vec3d axis(rig.random.normal(1), rig.random.normal(1), rig.random.normal(1));
            rig.turnCamera(1, TURN*DEGREE*cv::normalize(axis));
            const ScaledMatches seen = drawSeen(rig, { 20, options.count }, noise);
            const SceneMatches matches = SceneMatcher(rig.calibration, options).goodOf(seen);
            const CheckInput input{ modelOf(rig.calibration), rig.calibration.covariance, 0, 0 };
            for (const bool isNamed : { false, true })
            {
                const MayHaveTurned turned{ isNamed ? std::vector<double>{ 0, TURN } : std::vector<double>{ TURN }, 0 };
                const BundleStart start{ input.rig, GLASS_FIX_NORMAL, covarianceOfMoved(input, turned), {} };
                (isNamed ? named : either).add(rig, toFile(adjustBundle(start, matches.good.matches, {}, true), rig.calibration),
                                               rig.random);
            }
            asItWas.add(rig, rig.calibration, rig.random);
        }
        std::cout << cv::format("[numbers] %s, camera 2 turned by %.1f deg, %d rigs: error of points over stated %.2f; RMS %.3f mm; where "
                                "it is known which one turned %.2f; %.3f mm; with a fresh calibration by boards %.2f; %.3f mm; with the "
                                "calibration as it was %.3f mm\n", outerIndex > 1 ? "in water" : "in air", TURN, trials, either.ratio(),
                                either.rms(), named.ratio(), named.rms(), fresh.ratio(), fresh.rms(), asItWas.rms());
        CHECK(named.rms() < 1.5*fresh.rms());
        CHECK(either.rms() < 0.1*asItWas.rms());
        CHECK(either.ratio() < 1.3);
        CHECK(named.ratio() < 1.3);
    }
}
