// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Matches of rendered scenes against the truth, and checks of rigs by them.
#include "match_scene.hpp"
#include "assess/rig_check.hpp"
#include "match/scene_matches.hpp"
#include <catch2/catch.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <map>

using namespace match_scene;

namespace {

//! Matches against the truth.
struct Truth
{
    int wrong = 0, right = 0;
    double across = 0, along = 0;       //!< sums of squares over stated variances, of the right ones: across the curve, along it
    Point2d mean;

    Truth(const TexturedScene& scene, const RigModel& rig, const ScaledMatches& scaled)
    {
        const double SAME = 3;          // px
        const Matches& m = scaled.matches;
        const std::vector<Point2d> partners = truePartners(scene, rig, m.pixels[0]);
        const std::vector<MatchResidual> residuals = residualsOf(scaled, rig);
        for (int i = 0; i < scaled.size(); i++)
        {
            const Point2d off = m.pixels[1][i] - partners[i];
            const bool isRight = cv::norm(off) < SAME;
            wrong += !isRight;
            right += isRight;
            if (!isRight || m.stds.empty())
                continue;
            const double variance = m.stds[0][i]*m.stds[0][i] + m.stds[1][i]*m.stds[1][i];
            across += residuals[i].squares/(variance/2);
            along += std::max(0., off.dot(off) - 2*residuals[i].squares)/variance;
            mean += off;
        }
    }
};

CheckResult checkOf(const Calibration& calibration, const SceneMatches& matches, double falseAlarm)
{
    CheckInput input = checkInputOf(calibration, "", 0);
    input.sigma = matches.good.matches.usualStd();
    return checkScene(input, observationsOf(input.rig, matches.good.matches), falseAlarm, calibration.unit);
}

//! The calibration of a rig of which a camera has turned about its own centre since.
Calibration beforeTurn(Calibration calibration, const Vec3d& rvec)
{
    calibration.extrinsics[1] = RigidTransform{ rotationMatrix(rvec).t(), Vec3d() }*calibration.extrinsics[1];
    return calibration;
}

const char TURNED[] = "R of camera 2 (turned about its own centre) changed by";

} // namespace

TEST_CASE("Matches of a rendered scene are right, and as good as they say", "[tools][match]")
{
    for (const double outerIndex : { 1., 1.333 })
    {
        Rig rig(461, outerIndex);
        const TexturedScene room = roomOf(rig.random);
        const SceneMatcher matcher = matcherOf(rig.calibration);
        const ScaledMatches all = matcher.matchesOf("room", render(room, rig.truth, usualExposure(), 1));
        const SceneMatches result = matcher.goodOf(all);
        const Truth found(room, rig.truth, all), good(room, rig.truth, result.good);
        const double across = std::sqrt(good.across/good.right), along = std::sqrt(good.along/good.right);
        std::cout << cv::format("[numbers] matches %s: %d, wrong %d (said: %.1f; before the fit %d), good ones lost %d; error over "
                                "stated across the curves %.3f, along %.3f; std %.3f px, mean error %.4f %.4f px\n",
                                outerIndex > 1 ? "in water" : "in air",
                                good.right + good.wrong, good.wrong, result.wrongLeft, found.wrong, found.right - good.right, across, along,
                                result.good.matches.usualStd(), good.mean.x/good.right, good.mean.y/good.right);
        CHECK(good.right > 1000);
        CHECK(good.wrong < 0.005*good.right);
        CHECK(found.right - good.right < 0.2*found.right);
        CHECK(across > 0.9);
        CHECK(across < 1.1);
        CHECK(cv::norm(good.mean)*(1./good.right) < 0.01);      // no quarter of a pixel
    }
}

TEST_CASE("A scene shows in one pair that a camera turned by 0.05 degrees, and is silent where none did", "[tools][match][check]")
{
    const double FALSE_ALARM = 0.001;
    Rig rig(462);
    const TexturedScene room = roomOf(rig.random);
    const std::vector<cv::Mat> images = render(room, rig.truth, usualExposure(), 2);
    for (const double degrees : { 0., 0.05 })
    {
        const Vec3d turn = degrees*DEGREE*cv::normalize(Vec3d(1, 0.6, 0));
        const Calibration calibration = beforeTurn(rig.calibration, turn);
        const SceneMatcher matcher = matcherOf(calibration);
        const CheckResult result = checkOf(calibration, matcher.goodOf(matcher.matchesOf("room", images)), FALSE_ALARM);
        INFO(causesIn(result));
        CHECK(result.changed == (degrees > 0));
        REQUIRE(result.turns.size() == 2);
        CHECK(powerOf(result.turns[0], result, 0.1) > 0.95);
        const auto isTurn = [](const NamedChange& c) { return c.name == TURNED; };
        const auto named = std::find_if(result.changes.begin(), result.changes.end(), isTurn);
        CHECK((named != result.changes.end()) == (degrees > 0));
        if (named != result.changes.end())
            CHECK(std::abs(named->values[0].value - degrees) < 3.5*named->values[0].std);
    }
}

TEST_CASE("Three cameras have chains, and the one that turned is named", "[tools][match][check]")
{
    Calibration rig = nominalRig(1, 1);
    const Matx33d K(790, 0, 318, 0, 790, 257, 0, 0, 1);
    CameraCalibration third;
    third.camera = RefractiveCamera::create(K, std::vector<double>{ -0.2, 0.12, 0, 0, 0 },
                                            GlassWindow(Vec3d(0.1, 0.15, 0.97), 25, 1.517, 58, 1));
    third.camera->setImageSize(SIZE);
    rig.add(third, transformOf(Vec3d(-0.02, -0.2, 0.01), Vec3d(150, -3, 14)));
    RigModel truth = modelOf(rig);
    scenes::Random random(463);
    const TexturedScene room = roomOf(random);
    truth.extrinsics[2] = RigidTransform{ rotationMatrix(Vec3d(0.05*DEGREE, 0, 0)), Vec3d() }*truth.extrinsics[2];
    const SceneMatcher matcher = matcherOf(rig);
    const SceneMatches matches = matcher.goodOf(matcher.matchesOf("room", render(room, truth, usualExposure(), 3)));
    const Matches& m = matches.good.matches;
    int all = 0, wrong = 0;
    for (int c : { 1, 2 })
    {
        RigModel pair;
        pair.add(truth.cameras[0]);
        pair.add(truth.cameras[c], truth.extrinsics[c]);
        const std::vector<Point2d> partners = truePartners(room, pair, m.pixels[0]);
        for (int i = 0; i < matches.good.size(); i++)
            if (m.isSeen(0, i) && m.isSeen(c, i))
            {
                all += m.seenBy(i) == 3;
                wrong += !(cv::norm(m.pixels[c][i] - partners[i]) < 3);
            }
    }
    CHECK(all > 2*200);
    CHECK(wrong < 0.005*matches.good.size());
    CheckInput input = checkInputOf(rig, "", 0.05);
    input.sigma = m.usualStd();
    const CheckResult result = checkScene(input, observationsOf(input.rig, m), 0.001, "mm");
    INFO(causesIn(result));
    CHECK(result.changed);
    const auto named = std::find_if(result.changes.begin(), result.changes.end(), [](const NamedChange& c) {
        return c.name == "R of camera 3 (turned about its own centre) changed by"; });
    REQUIRE(named != result.changes.end());
    const ValueAboutAxis& aboutX = named->values[0].aboutAxes[0];
    CHECK(std::abs(aboutX.value - 0.05) < 4*aboutX.std);
    CHECK(aboutX.std < 0.005);
    CHECK(result.mayHaveTurned == std::vector<int>{ 2 });       // two others tell which
}

// TRIALS=50 refract_tools_tests "[scene-reach]": what checks by scenes reach, pairs of 640x512.
TEST_CASE("What checks by a scene reach", "[tools][.monte-carlo][scene-reach]")
{
    const int trials = scenes::trials(20);
    const double FALSE_ALARM = 0.01;
    for (const double outerIndex : { 1., 1.333 })
    {
        int alarms = 0, wrong = 0, right = 0, lost = 0;
        double across = 0, along = 0, said = 0;
        std::map<double, std::array<int, 3>> found;             // of turns: found, named, named first
        std::map<double, std::vector<double>> errors;
        std::vector<double> seconds;
        std::vector<double> probabilities;
        for (int trial = 0; trial < trials; trial++)
        {
            Rig rig(1000 + trial, outerIndex);
            const TexturedScene room = roomOf(rig.random);
            const std::vector<cv::Mat> images = render(room, rig.truth, usualExposure(), trial);
            const double direction = rig.random.uniform(0, 2*CV_PI);
            for (const double degrees : { 0., 0.02, 0.05 })
            {
                const Calibration calibration = beforeTurn(rig.calibration,
                                                           degrees*DEGREE*Vec3d(std::cos(direction), std::sin(direction), 0));
                const SceneMatcher matcher = matcherOf(calibration);
                const int64 start = cv::getTickCount();
                const ScaledMatches all = matcher.matchesOf("room", images);
                const SceneMatches matches = matcher.goodOf(all);
                const CheckResult result = checkOf(calibration, matches, FALSE_ALARM);
                if (degrees > 0)
                {
                    found[degrees][0] += result.changed;
                    for (size_t i = 0; i < result.changes.size(); i++)
                        if (result.changes[i].name == TURNED)
                        {
                            found[degrees][1]++;
                            found[degrees][2] += i == 0;
                            errors[degrees].push_back((result.changes[i].values[0].value - degrees)/result.changes[i].values[0].std);
                        }
                    continue;
                }
                seconds.push_back((cv::getTickCount() - start)/cv::getTickFrequency());
                alarms += result.changed;
                for (const TurnCheck& turn : result.turns)
                    probabilities.push_back(turn.probability);
                const Truth before(room, rig.truth, all), good(room, rig.truth, matches.good);
                wrong += good.wrong;
                right += good.right;
                lost += before.right - good.right;
                across += good.across;
                along += good.along;
                said += matches.wrongLeft;
            }
        }
        std::sort(seconds.begin(), seconds.end());
        std::sort(probabilities.begin(), probabilities.end());
        std::cout << cv::format("[numbers] scenes %s, %d trials of one pair: false alarms %d (stated %.1f); p of a turn, quartiles %.2f "
                                "%.2f %.2f; wrong matches %.2f %% (said %.2f %%), good ones lost %.1f %%; std: error over stated "
                                "across %.3f, along %.3f; %.2f s (median)\n",
                                outerIndex > 1 ? "in water" : "in air", trials, alarms, trials*FALSE_ALARM,
                                probabilities[probabilities.size()/4], probabilities[probabilities.size()/2],
                                probabilities[3*probabilities.size()/4], 100.*wrong/(wrong + right), 100.*said/(wrong + right),
                                100.*lost/(lost + right), std::sqrt(across/right), std::sqrt(along/right), seconds[seconds.size()/2]);
        for (const auto& turn : found)
        {
            double squares = 0;
            for (double e : errors[turn.first])
                squares += e*e;
            std::cout << cv::format("[numbers]   turned by %.2f degrees: found %d, named %d, first %d; error of the angle over stated "
                                    "%.2f\n", turn.first, turn.second[0], turn.second[1], turn.second[2],
                                    std::sqrt(squares/std::max<size_t>(1, errors[turn.first].size())));
        }
        CHECK(alarms <= 1 + 3*trials*FALSE_ALARM);
        CHECK(std::sqrt(across/right) == Approx(1).epsilon(0.1));
    }
}
