// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Views with too few points for a pose: left out by name, or refused by name where nothing would be left.
#include "calibrate/outliers.hpp"
#include <catch2/catch.hpp>

using namespace cv;
using namespace tools;

namespace {

const std::vector<Point3d> SQUARE = {{0, 0, 0}, {40, 0, 0}, {0, 30, 0}, {40, 30, 0}, {20, 15, 0}},
                           LINE = {{0, 0, 0}, {10, 10, 0}, {20, 20, 0}, {30, 30, 0}, {0, 30, 0}};

DetectedImage image(const std::string& name, std::vector<Point3d> object, size_t count)
{
    object.resize(count);
    DetectedImage result{name, "points2.csv", {}, object};
    for (const Point3d& X : object)
        result.points.emplace_back(100 + X.x, 100 + X.y);
    return result;
}

RigImages setsOf(const std::vector<DetectedImage>& images)
{
    RigImages sets;
    sets.glass[1].images = images;
    return sets;
}

} // namespace

TEST_CASE("Views with too few points are left out, and named with what they have", "[few_points]")
{
    DetectedImage unseen = image("unseen", SQUARE, 2);
    unseen.points.assign(2, Point2d(NAN, NAN));
    RigImages sets = setsOf({image("four", SQUARE, 4), image("three", SQUARE, 3), unseen, image("line", LINE, 4),
                             image("one beside", LINE, 5), image("five", SQUARE, 5)});
    const std::vector<Rejected> rejected = leaveOutFewPoints(nullptr, sets);
    REQUIRE(sets.glass[1].images.size() == 2);
    CHECK(sets.glass[1].images[0].stem == "four");
    CHECK(sets.glass[1].images[1].stem == "five");
    REQUIRE(rejected.size() == 3);
    CHECK_THAT(rejected[0].sentence(), Catch::Contains("'three' (camera 2, through the window)") && Catch::Contains("3 points, but")
                                      && Catch::Contains("needs 4"));
    CHECK_THAT(rejected[1].sentence(), Catch::Contains("'line'") && Catch::Contains("on a line"));
    CHECK_THAT(rejected[2].sentence(), Catch::Contains("'one beside'") && Catch::Contains("on a line"));
}

TEST_CASE("Where no view of a camera has points enough, camera, view and what it needs are named", "[few_points]")
{
    RigImages sets = setsOf({image("a", SQUARE, 3), image("b", SQUARE, 1)});
    CHECK_THROWS_WITH(leaveOutFewPoints(nullptr, sets), Catch::Contains("camera 2, --glass2='points2.csv'")
                      && Catch::Contains("view 'a' has 3 points") && Catch::Contains("needs 4") && Catch::Contains("Give more"));
}
