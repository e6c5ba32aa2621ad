// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Indices as users give them: numbers and names.
#include "calibrate/given_std.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include <catch2/catch.hpp>
#include <opencv2/refract.hpp>
#include <cmath>

using namespace cv::refract;
using namespace tools;
using Catch::Matchers::Contains;

TEST_CASE("An index is a number or a material's name", "[given_index]")
{
    const GivenIndex number = readIndex("1.333", lightOf(BRIGHTNESS, 550.), "--outer-index");
    CHECK(number.value == 1.333);
    CHECK_FALSE(number.isNamed());
    const GivenIndex sea = readIndex("seawater:T=12,S=35", lightOf(BRIGHTNESS, 500.), "--outer-index");
    CHECK(sea.isNamed());
    CHECK(sea.value == refractiveIndex("seawater:T=12,S=35", 500.));
    CHECK(sea.sentence() == cv::format("the index of seawater:T=12,S=35 at 500 nm: %.5f", sea.value));

    const std::vector<GivenIndex> layers = readIndices("N-BK7, PMMA,1.5", lightOf(BRIGHTNESS, 550.), "--index");
    REQUIRE(layers.size() == 3);
    CHECK(layers[0].value == refractiveIndex("N-BK7"));
    CHECK(layers[1].value == refractiveIndex("PMMA"));
    CHECK(layers[2].value == 1.5);
    CHECK_FALSE(layers[2].isNamed());
}

TEST_CASE("A named index may be off by what the colours of white light change it by, and its kind", "[given_index]")
{
    const auto deviation = [](const char* name, double nm) { return readIndex(name, lightOf(BRIGHTNESS, nm), "--index").deviation; };
    const double colours = 0.5*(refractiveIndex("soda-lime", 450.) - refractiveIndex("soda-lime", 650.));
    CHECK(deviation("soda-lime", 550.) == Approx(std::hypot(colours, refractiveIndexTolerance("soda-lime"))));
    CHECK(deviation("N-BK7", 550.) == Approx(0.0054).epsilon(0.02));
    CHECK(deviation("water", 550.) == Approx(0.0041).epsilon(0.05));
    // Infrared light is of a lamp that gives no other.
    CHECK(deviation("N-BK7", 850.) == refractiveIndexTolerance("N-BK7"));
    CHECK(readIndex("N-BK7", lightOf(BRIGHTNESS, 850.), "--index").light() == "N-BK7");
}

TEST_CASE("The index of a channel is known better than that of white light", "[given_index]")
{
    const GivenIndex blue = readIndex("water", lightOf(BLUE), "--outer-index"), white = readIndex("water", Light(), "--outer-index");
    CHECK(blue.value == refractiveIndex("water", 465.));
    CHECK(blue.light() == "water, light of 430 to 500 nm");
    CHECK(blue.deviation < 0.6*white.deviation);
    CHECK(lightOf(GREEN).wavelength == 540.);
    CHECK(lightOf(RED).wavelength == 610.);
    CHECK(lightOf(GREEN, 525.).wavelength == 525.);
    CHECK(lightOf(GREEN, 525.).shortest == 490.);
}

TEST_CASE("A wrong index names its option", "[given_index]")
{
    CHECK_THROWS_WITH(readIndex("watr", lightOf(BRIGHTNESS, 550.), "--outer-index"),
                      Contains("--outer-index=watr: ") && Contains("'water'"));
    CHECK_THROWS_WITH(readIndex("1.3,1.4", lightOf(BRIGHTNESS, 550.), "--outer-index"),
                      Contains("--outer-index=1.3,1.4: give one number"));
    CHECK_THROWS_WITH(readIndex("", lightOf(BRIGHTNESS, 550.), "--outer-index"), Contains("--outer-index"));
    CHECK_THROWS_WITH(readIndex("nan", lightOf(BRIGHTNESS, 550.), "--outer-index"), Contains("not a number"));
    CHECK_THROWS_WITH(readIndices("1.5,,1.5", lightOf(BRIGHTNESS, 550.), "--index"), Contains("--index"));
    CHECK_THROWS_WITH(readIndices("seawater:T=12,S=35", lightOf(BRIGHTNESS, 550.), "--index"), Contains("without parameters"));
    CHECK_THROWS_AS(readIndices("N-BK7,glass", lightOf(BRIGHTNESS, 550.), "--index"), Failure);
}
