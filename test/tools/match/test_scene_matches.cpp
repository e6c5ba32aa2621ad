// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match_scene.hpp"
#include "assess/rig_check.hpp"
#include "match/scene_check.hpp"
#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>
#include <map>

using namespace match_scene;

TEST_CASE("Matches of a rendered scene are right, and as good as they say", "[tools][match]")
{
    for (const double outerIndex : { 1., 1.333 })
    {
        const unsigned seed = scenes::seed() + 461;
        Rig rig(seed, outerIndex);
        const TexturedScene room = roomOf(rig.random);
        const std::vector<cv::Mat> images = render(room, rig.truth, usualExposure(), seed);
        SceneOptions options;
        options.depth = DEPTH;
        const SceneMatcher matcher(rig.calibration, options);
        const ScaledMatches all = matcher.matchesOf("room", images);
        const SceneMatches result = matcher.goodOf(all);
        const Matches& m = result.good.matches;
        const std::vector<Point2d> partners = truePartners(room, rig.truth, m.pixels[0]);
        const auto wrongOf = [&](const Matches& matches) {
            const std::vector<Point2d> right = truePartners(room, rig.truth, matches.pixels[0]);
            int wrong = 0;
            for (size_t i = 0; i < right.size(); i++)
                wrong += !(cv::norm(right[i] - matches.pixels[1][i]) < 3);
            return wrong;
        };
        const std::vector<MatchResidual> across = residualsOf(result.good, rig.truth), everything = residualsOf(all, rig.truth);
        std::map<int, std::vector<double>> byScale, byScaleAlong;
        double along = 0, sum = 0;
        Point2d mean;
        int count = 0;
        for (size_t i = 0; i < partners.size(); i++)
        {
            const Point2d off = m.pixels[1][i] - partners[i];
            if (!(cv::norm(off) < 3))
                continue;
            const double variance = m.stds[0][i]*m.stds[0][i] + m.stds[1][i]*m.stds[1][i];
            const double other = std::max(0., off.dot(off) - 2*across[i].squares);
            along += other/variance;
            sum += across[i].squares/(variance/2);
            mean += off;
            const int bin = (int)std::floor(std::log2(across[i].scale2));
            byScale[bin].push_back(across[i].squares/(variance/2));
            byScaleAlong[bin].push_back(other/variance);
            count++;
        }
        std::cout << cv::format("[numbers] found %d chosen %d left out %d good %zu search %.1f: wrong of found %d, of good %d (expected %.1f); error over stated: across %.3f, along %.3f; mean %.3f %.3f, std %.3f (%.3f, %.3f)\n",
            result.found, result.chosen, result.leftOut, partners.size(), result.search, wrongOf(all.matches), wrongOf(m), result.wrongLeft,
            std::sqrt(sum/count), std::sqrt(along/count), mean.x/count, mean.y/count, m.usualStd(), result.noise.floor, result.noise.share);
        const auto rms = [](const std::vector<double>& v) { double sum = 0; for (double x : v) sum += x; return std::sqrt(sum/v.size()); };
        for (auto& b : byScale)
        {
            std::vector<double> v = b.second;
            std::sort(v.begin(), v.end());
            std::cout << cv::format("   scale %.2f: n %zu across: rms %.2f median %.2f 90%% %.2f 99%% %.2f; along %.2f\n", std::pow(2., (b.first + 0.5)/2), v.size(), rms(v),
                std::sqrt(v[v.size()/2])/0.6745, std::sqrt(v[v.size()*9/10])/1.645, std::sqrt(v[v.size()*99/100])/2.576, rms(byScaleAlong[b.first]));
        }
        // raw error of all found, by scale
        std::map<int, std::vector<double>> raw;
        for (size_t i = 0; i < everything.size(); i++)
            if (everything[i].count)
                raw[(int)std::floor(std::log2(everything[i].scale2))].push_back(everything[i].squares);
        for (auto& b : raw)
        {
            std::vector<double> v = b.second;
            std::sort(v.begin(), v.end());
            std::cout << cv::format("   all of scale %.2f: n %zu px by median %.4f, 90%% %.4f 95%% %.4f 99%% %.4f\n", std::pow(2., (b.first + 0.5)/2), v.size(),
                std::sqrt(v[v.size()/2])/0.6745, std::sqrt(v[v.size()*9/10])/1.645, std::sqrt(v[v.size()*95/100])/1.96,std::sqrt(v[v.size()*99/100])/2.576);
        }
    }
}

TEST_CASE("A check by a scene", "[tools][match][xx]")
{
    for (const double outerIndex : { 1., 1.333 })
    for (const double turn : { 0., 0.05 })
    {
        const unsigned seed = scenes::seed() + 461;
        Rig rig(seed, outerIndex);
        rig.turnCamera(1, Vec3d(turn*DEGREE, 0, 0));
        const TexturedScene room = roomOf(rig.random);
        const std::vector<cv::Mat> images = render(room, rig.truth, usualExposure(), seed);
        SceneOptions options;
        options.depth = DEPTH;
        const SceneMatcher matcher(rig.calibration, options);
        const SceneMatches result = matcher.goodOf(matcher.matchesOf("room", images));
        CheckInput input = checkInputOf(rig.calibration, "", 0);
        input.sigma = result.good.matches.usualStd();
        int64 t0 = cv::getTickCount();
        const CheckResult check = checkScene(input, observationsOf(input.rig, result.good.matches), 0.01, "mm");
        std::cout << "time " << (cv::getTickCount() - t0)/cv::getTickFrequency() << " changed " << check.changed << " " << causesIn(check) << " explained " << check.explained << " sigma " << input.sigma << " " << check.sigma << " critical " << check.critical << std::endl;
        for (auto& t : check.turns)
            std::cout << "   " << t.name << " std " << t.stdDeg << " p " << t.probability << " power " << powerOf(t, check, 0.1) << std::endl;
        for (auto& w : check.windows)
            std::cout << "   window " << w.camera << " std " << w.stdDeg[0] << std::endl;
    }
}
