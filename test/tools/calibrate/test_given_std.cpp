// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// How well given values are known: said, or usual.
#include "calibrate/given_std.hpp"
#include "console/failure.hpp"
#include "console/options.hpp"
#include "scenes.hpp"
#include <opencv2/refract.hpp>

using namespace tools;

namespace {

GivenStd read(const std::vector<std::string>& options, const GivenValues& values)
{
    OptionParser parser;
    GivenStdOptions std;
    std.addTo(parser);
    parser.parse(options);
    return std.of(values);
}

GivenValues pane()
{
    GivenValues values;
    GivenIndex glass;
    glass.value = 1.52;
    values.layers = {glass};
    values.square = 40.;
    return values;
}

const double MINUTE = CV_PI/180/60;

} // namespace

TEST_CASE("What is said of nothing is known as values of its kind are", "[given]")
{
    const GivenStd std = read({}, pane());
    CHECK(std.thickness == 0.1);
    CHECK(std.indexOf(0) == 0.001);
    CHECK(std.wedge == Approx(MINUTE));
    CHECK(std.scale == 5e-4);
    CHECK(std.placement == 0.02);
    CHECK(std.thickness.text(" mm") == "0.1 mm (default)");
    // Equal media: their index is what the others are relative to, the distance has no effect.
    CHECK(std.outerIndex == 0.);
    CHECK(std.distance == 0.);

    GivenValues water = pane();
    water.equalMedia = false;
    water.outer.value = 1.333;
    CHECK(read({}, water).outerIndex == 0.001);
    CHECK(read({}, water).distance == 0.);          // is estimated
    water.distance = true;
    CHECK(read({}, water).distance == 1.);
    water.millimetre = 0.001;                       // lengths in metres
    CHECK(read({}, water).distance == 0.001);
    CHECK(read({}, water).thickness == Approx(1e-4));
}

TEST_CASE("A material says how well its index is known; the gap of double glazing is air", "[given]")
{
    GivenValues values = pane();
    values.layers[0].name = values.layers[0].material = "N-BK7";
    values.layers[0].deviation = 0.003;
    values.layers.resize(3, values.layers[0]);
    values.layers[1] = GivenIndex();
    const GivenStd std = read({}, values);
    CHECK(std.indexOf(0) == Approx(0.003/std::sqrt(3.)));
    CHECK(std.indexOf(0).source.find("N-BK7") == 0);
    CHECK(std.indexOf(1) == 0.);
    CHECK(std.ofIndices());
    CHECK(read({"--index-std=0.002"}, values).indexOf(1) == 0.002);
}

TEST_CASE("What is said holds, 0 is exact, and what is free has no default", "[given]")
{
    const GivenStd said = read({"--thickness-std=0.02", "--wedge-std=3", "--square-std=0.01", "--placement-std=0"}, pane());
    CHECK(said.thickness == 0.02);
    CHECK(said.thickness.text(" mm") == "0.02 mm");
    CHECK(said.wedge == Approx(3*MINUTE));
    CHECK(said.scale == Approx(0.01/40));
    CHECK(said.placement == 0.);
    CHECK(said.indexOf(0) == 0.001);
    const GivenStd exact = read({"--exact", "--index-std=0.002"}, pane());
    CHECK(exact.thickness == 0.);
    CHECK(exact.wedge == 0.);
    CHECK(exact.placement == 0.);
    CHECK(exact.indexOf(0) == 0.002);
    GivenValues free = pane();
    free.flags = cv::refract::GLASS_FREE_THICKNESS | cv::refract::GLASS_FREE_INDEX | cv::refract::GLASS_FREE_WEDGE;
    CHECK(read({}, free).thickness == 0.);
    CHECK_FALSE(read({}, free).ofIndices());
    CHECK(read({}, free).wedge == 0.);
    CHECK(read({"--thickness-std=0.5"}, free).thickness == 0.5);
}

TEST_CASE("A deviation of what there is not is refused", "[given]")
{
    GivenValues bare = pane();
    bare.layers.clear();
    CHECK_THROWS_AS(read({"--wedge-std=1"}, bare), Failure);
    CHECK_THROWS_AS(read({"--distance-std=1"}, pane()), Failure);
    GivenValues water = pane();
    water.equalMedia = false;
    CHECK_THROWS_AS(read({"--distance-std=1"}, water), Failure);
    GivenValues points = pane();
    points.square = 0.;
    CHECK_THROWS_WITH(read({"--square-std=0.1"}, points), Catch::Contains("--scale-std"));
    CHECK(read({"--scale-std=0.05"}, points).scale == Approx(5e-4));
    CHECK_THROWS_AS(read({"--scale-std=0.05"}, pane()), Failure);
    CHECK(read({}, points).scale == Approx(5e-4));          // as of a board: nobody's points are exact
    CHECK(read({"--exact"}, points).scale == 0.);
    CHECK_THROWS(read({"--thickness-std=-1"}, pane()));
    CHECK_THROWS(read({"--thickness-std=nan"}, pane()));
}

TEST_CASE("What is known of domes and bent panes has its own options", "[given]")
{
    GivenValues dome = pane();
    dome.shape = cv::refract::WINDOW_DOME;
    const GivenStd std = read({}, dome);
    CHECK(std.radius == 0.1);
    CHECK(std.center == 0.);
    CHECK(std.wedge == 0.);                         // spheres of one centre have none
    CHECK(std.curvature == 0.);
    CHECK(read({"--radius-std=0.02", "--center-std=0.5"}, dome).radius == 0.02);
    CHECK(read({"--center-std=0.5"}, dome).center == 0.5);
    CHECK(read({"--exact"}, dome).radius == 0.);
    GivenValues tube = dome;
    tube.shape = cv::refract::WINDOW_TUBE;
    CHECK(read({"--center-std=0.5"}, tube).center == 0.5);
    dome.flags = cv::refract::GLASS_FREE_RADIUS;
    CHECK(read({}, dome).radius == 0.);
    // A sag of 2 mm over a metre is a radius of 62.5 m.
    CHECK(read({}, pane()).curvature == 0.);
    CHECK(read({"--bow-std=2"}, pane()).curvature == Approx(1/62500.));
    GivenValues metres = pane();
    metres.millimetre = 0.001;
    CHECK(read({"--bow-std=2"}, metres).curvature == Approx(1/62.5));
    for (const char* option : {"--wedge-std=1", "--distance-std=1", "--bow-std=1"})
        CHECK_THROWS_AS(read({option}, dome), Failure);
    for (const char* option : {"--radius-std=1", "--center-std=1"})
        CHECK_THROWS_AS(read({option}, pane()), Failure);
    GivenValues surface = pane();
    surface.layers.clear();
    CHECK_THROWS_AS(read({"--bow-std=1"}, surface), Failure);
}
