// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What errs together, by less than one match shows.
#include "drawn_matches.hpp"
#include "assess/rig_check.hpp"
#include "match/scene_matches.hpp"
#include <catch2/catch.hpp>
#include <algorithm>
#include <map>

using namespace match_scene;

TEST_CASE("A part of an image that moved by less than one match shows is left out as a whole", "[tools][match]")
{
    const double SIGMA = 0.05, MOVED = 3*SIGMA;
    Rig rig(478);
    const FeatureNoise noise{ { SIGMA }, 0, 0, { { 1, 1 } } };
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

TEST_CASE("Where most of a part of all images moves, what is near its curves by chance does not tell the rig", "[tools][match][check]")
{
    const double SIGMA = 0.06, MOVED = 4;
    for (unsigned salt = 480; salt < 486; salt++)
    {
        Rig rig(salt, salt % 2 ? 1.333 : 1);
        const FeatureNoise noise{ { SIGMA }, 0, 0, { { 1, 1 } } };
        ScaledMatches all = drawSeen(rig, { 15, 1800 }, noise);
        std::map<std::string, Point2d> moved;
        int moving = 0;
        const auto moves = [](const Matches& m, int i) { return m.pixels[0][i].y > 0.6*SIZE.height; };
        for (int i = 0; i < all.size(); i++)
            if (moves(all.matches, i))
            {
                const auto of = moved.insert({ all.matches.names[i].image, {} });
                if (of.second)
                    of.first->second = Point2d(rig.random.uniform(-MOVED, MOVED), rig.random.uniform(-MOVED, MOVED));
                all.matches.pixels[1][i] += of.first->second;
                moving++;
            }
        const Matches good = matcherOf(rig.calibration).goodOf(all).good.matches;
        int left = 0;
        for (int i = 0; i < (int)good.names.size(); i++)
            left += moves(good, i);
        CAPTURE(scenes::seed(), salt, moving, left);
        CHECK(left < 0.05*moving);
        CHECK((int)good.names.size() - left > 0.9*(all.size() - moving));
        CheckInput input = checkInputOf(rig.calibration, "", 0);
        input.sigma = good.usualStd();
        CHECK(!checkScene(input, observationsOf(input.rig, good), 0.001, "mm").changed);
    }
}

TEST_CASE("Details at one place at all moments that miss together by less than one match shows are left out", "[tools][match]")
{
    const double SIGMA = 0.05;
    Rig rig(488, 1.333);
    const FeatureNoise noise{ { SIGMA }, 0, 0, { { 1, 1 } } };
    ScaledMatches all = drawSeen(rig, { 8, 1200 }, noise);
    const int right = all.size();
    const ScaledMatches reflection = drawMatches("", roomOf(rig.random), rig.truth, noise, 60, rig.random);
    for (int moment = 0; moment < 8; moment++)
    {
        ScaledMatches here = reflection;
        for (int i = 0; i < here.size(); i++)
        {
            here.matches.names[i] = { std::to_string(moment), "reflected" };
            here.matches.pixels[1][i] += Point2d(rig.random.normal(SIGMA), 2*SIGMA + rig.random.normal(SIGMA));
        }
        all.add(here);
    }
    const Matches good = matcherOf(rig.calibration).goodOf(all).good.matches;
    const int left = (int)std::count_if(good.names.begin(), good.names.end(), [](const PointName& n) { return n.id == "reflected"; });
    CAPTURE(scenes::seed(), left);
    CHECK(left < 15);
    CHECK((int)good.names.size() - left > 0.95*right);
}
