// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// How well features are placed, by their size and likeness.
#include "drawn_matches.hpp"
#include "match/match_noise.hpp"
#include <catch2/catch.hpp>
#include <cmath>

using namespace match_scene;

TEST_CASE("What looks unlike in its images is placed less well, which its std says, whatever is wrong beside it", "[tools][match]")
{
    const MatchNoise truth{ 0.03, 0.01, 0.05 };
    Rig rig(489);
    FeatureNoise drawn{ truth, 0, 0.25, { { 1, 1 }, { 1.5, 1.5 }, { 3, 3 } }, { 0.4, 1, 2.5 } };
    drawn.scales.insert(drawn.scales.end(), { { 1, 1 }, { 3, 3 }, { 1, 1 } });
    drawn.unlike.insert(drawn.unlike.end(), { 2.5, 0.4, 1 });
    const ScaledMatches all = drawSeen(rig, { 2, 2000 }, drawn);
    const MatchNoise noise = noiseOf(residualsOf(all, rig.truth));
    for (const double scale : { 1., 3. })
        for (const double unlike : { 0.4, 1., 2.5 })
        {
            CAPTURE(scenes::seed(), scale, unlike);
            CHECK(noise.stdOf(scale, unlike) == Approx(truth.stdOf(scale, unlike)).epsilon(0.1));
        }
}

TEST_CASE("Matches that look so unlike that many of them miss are left out, unless all miss as often", "[tools][match]")
{
    scenes::Random random(490);
    const MatchNoise noise{ 0.1 };
    for (const bool onlyUnlike : { true, false })
    {
        std::vector<MatchResidual> residuals;
        for (int i = 0; i < 1600; i++)
        {
            const double unlike = random.uniform(0.3, 2), miss = random.normal(0.1);
            const bool isWrong = (!onlyUnlike || unlike > 1.8) && random.uniform(0, 1) < 0.2;
            residuals.push_back({ isWrong ? 4. : miss*miss, 1, unlike, 1 });
        }
        const double limit = unlikeLimitOf(residuals, noise);
        CAPTURE(scenes::seed(), limit);
        if (onlyUnlike)
            CHECK(std::abs(limit - 1.8) < 0.12);
        else
            CHECK(limit > 2);
    }
}
