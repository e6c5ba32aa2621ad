// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Matches of a rig that is as it was calibrated contradict nothing that is known of it; of one that is not, they do.
#include "bundle/bundle_findings.hpp"
#include "assess/fitted_rig.hpp"
#include "match/drawn_matches.hpp"
#include <catch2/catch.hpp>

using namespace match_scene;

namespace {

//! What one moment of a rig says of what is known of it, as refract_bundle takes it; nothing is free.
std::string contradictionIn(const RigModel& truth, const RigModel& known, const cv::Mat& covariance, scenes::Random& random)
{
    const FeatureNoise noise{{0.1}, 0, 0, {{1, 1}}};
    const Matches matches = drawMatches("1", roomOf(random), truth, noise, 800, random).matches;
    const BundleStart start{known, GLASS_FIX_NORMAL, covariance, {}};
    const auto adjust = [&](const BundleStart& from) { return adjustBundle(from, matches, {}, true); };
    return contradictionOf(start, adjust(start), adjust);
}

//! Panes in air, which may have wedges, nobody says how far away; calibrated by eight pairs.
tools::RigCalibration calibratedWedges(unsigned seed)
{
    tools::GivenStd std;
    std.thickness = 0.05;
    std.index = {0.001};
    std.wedge = 1*CV_PI/180/60;
    std.distance = 200.;
    std.isDistanceOpen = true;
    return calibratedPairs(std, seed, 0.05, 39, GLASS_FREE_INTRINSICS);
}

} // namespace

TEST_CASE("Matches of an unchanged rig contradict nothing that is known of it", "[tools][bundle]")
{
    CAPTURE(scenes::seed());
    for (int trial = 0; trial < scenes::trials(12); trial++)
    {
        const tools::RigCalibration c = calibratedWedges(3100 + trial);
        scenes::Random random(3100 + trial);
        CAPTURE(trial);
        CHECK(contradictionIn(paperRig(2), c.fit.rig, c.fit.covariance, random) == "");
    }
}

TEST_CASE("What was known of a rig that has changed is contradicted by matches", "[tools][bundle]")
{
    CAPTURE(scenes::seed());
    for (int trial = 0; trial < scenes::trials(4); trial++)
    {
        const tools::RigCalibration c = calibratedWedges(3200 + trial);
        RigModel truth = paperRig(2);
        truth.extrinsics[1].R = rotationMatrix(Vec3d(0, 0.01, 0))*truth.extrinsics[1].R;
        scenes::Random random(3200 + trial);
        CAPTURE(trial);
        CHECK(contradictionIn(truth, c.fit.rig, c.fit.covariance, random).find("standard deviations from what the start says")
              != std::string::npos);
    }
}
