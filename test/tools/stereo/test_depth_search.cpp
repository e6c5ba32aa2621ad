// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "scene_pair.hpp"
#include "stereo/wide_search.hpp"
#include <catch2/catch.hpp>
#include <cmath>

using namespace tools;

TEST_CASE("The range of a scene is found from what both images show", "[tools][stereo][search]")
{
    const ScenePair scene;
    const std::vector<float> depths = depthsOfFeatures(scene.rig, scene.left, scene.right);
    REQUIRE(depths.size() > 500);
    CHECK(std::is_sorted(depths.begin(), depths.end()));
    const cv::Vec2d range = depthRangeOf(depths, scene.rig);
    CHECK(range[0] > 400);
    CHECK(range[0] < 475);
    CHECK(range[1] > 1130);
    CHECK(range[1] < 1350);
}

TEST_CASE("Without details in common no range is found, and --depth asked for", "[tools][stereo][search]")
{
    const ScenePair scene;
    const cv::Mat black(scene.left.size(), CV_8U, cv::Scalar(0));
    CHECK(depthsOfFeatures(scene.rig, black, black).empty());
    CHECK(depthsOfFeatures(scene.rig, scene.left, black).empty());
    for (const size_t few : {0, 29})
        CHECK_THROWS_WITH(depthRangeOf(std::vector<float>(few, 500.f), scene.rig), Catch::Contains("--depth=NEAR,FAR"));
    const cv::Vec2d enough = depthRangeOf(std::vector<float>(30, 500.f), scene.rig);
    CHECK(enough[0] < 480);
    CHECK(enough[1] > 520);
}

TEST_CASE("A few wrong partners do not widen the range", "[tools][stereo][search]")
{
    const ScenePair scene;
    std::vector<float> depths = {3, 5};
    for (int i = 0; i < 300; i++)
        depths.push_back(500.f + (float)i);
    depths.insert(depths.end(), {50000, 1e6});
    const cv::Vec2d range = depthRangeOf(depths, scene.rig);
    CHECK(range[0] > 400);
    CHECK(range[1] < 900);
}

TEST_CASE("A range that is found does not begin in the window", "[tools][stereo][search]")
{
    const ScenePair scene;      // the window is 60 away and 25 thick
    CHECK(depthRangeOf(std::vector<float>(40, 90.f), scene.rig)[0] == 90);
    CHECK(depthRangeOf(std::vector<float>(40, 110.f), scene.rig)[0] == Approx(100));
}

TEST_CASE("What lies before or in the window is told from what lies beyond", "[tools][stereo][search]")
{
    const ScenePair scene;      // the window is 60 away and 25 thick
    for (const double z : {1., 30., 60., 75.})
        CHECK(!isBeyondWindows(scene.rig, z));
    for (const double z : {100., 450., 1e6, (double)INFINITY})
        CHECK(isBeyondWindows(scene.rig, z));
}
