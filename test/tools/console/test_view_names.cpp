// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What images of one moment are found by.
#include "console/view_names.hpp"
#include <catch2/catch.hpp>

using namespace tools;

typedef std::vector<std::string> Names;

namespace {

std::vector<Names> takenOff(std::vector<Names> names)
{
    takeOffCameras(names);
    return names;
}

} // namespace

TEST_CASE("A camera's own part is taken off the names of its images", "[view_names]")
{
    const std::vector<Names> counted = {{"01", "02", "11"}, {"01", "02", "11"}};
    CHECK(takenOff({{"left01", "left02", "left11"}, {"right01", "right02", "right11"}}) == counted);
    CHECK(takenOff({{"201_01", "201_02", "201_11"}, {"202_01", "202_02", "202_11"}}) == counted);
    CHECK(takenOff({{"01_left", "02_left", "11_left"}, {"01_right", "02_right", "11_right"}}) == counted);
    CHECK(takenOff({{"cam0/01", "cam0/02", "cam0/11"}, {"cam1/01", "cam1/02", "cam1/11"}}) == counted);
    CHECK(takenOff({{"01/cam0", "02/cam0", "11/cam0"}, {"01/cam1", "02/cam1", "11/cam1"}}) == counted);
    // Digits that all moments of one camera begin with, and those of the other do not.
    CHECK(takenOff({{"l01", "l02"}, {"r01", "r02", "r11"}}) == std::vector<Names>{{"01", "02"}, {"01", "02", "11"}});
    CHECK(takenOff({{"l01"}, {"r01", "r02"}, {"t02", "t03"}}) == std::vector<Names>{{"01"}, {"01", "02"}, {"02", "03"}});
    // A pair without and with the window has one name twice.
    CHECK(takenOff({{"l01", "l02", "l01"}, {"r01", "r02", "r01"}}) == std::vector<Names>{{"01", "02", "01"}, {"01", "02", "01"}});
}

TEST_CASE("Names stay where some are equal already, or none would be", "[view_names]")
{
    for (const std::vector<Names>& names : {std::vector<Names>{{"left01", "left02"}, {"left02", "left03"}},
                                            {{"left01", "left02"}, {"right11", "right12"}}, {{"a", "b"}, {"c", "d"}}, {{"left01",
                                                                                                                        "left02"}}})
        CHECK(takenOff(names) == names);
}

TEST_CASE("Names stay where counters that differ have one number in common", "[view_names]")
{
    const std::vector<Names> names = {{"IMG_041", "IMG_042", "IMG_043"}, {"DSC_043", "DSC_044", "DSC_045"}};
    CHECK(takenOff(names) == names);
}

TEST_CASE("Cameras with one image each have one moment", "[view_names]")
{
    CHECK(takenOff({{"cam3"}, {"cam4"}, {"x", "x"}}) == std::vector<Names>{{"cam3"}, {"cam3"}, {"cam3", "cam3"}});
}

TEST_CASE("A pattern says where the moment stands in a name", "[view_names]")
{
    CHECK(momentOf("a/cam1_run2_0005.png", "cam*_{}") == "run2_0005");
    CHECK(momentOf("a/cam1_run2_0005.png", "*_*_{}") == "0005");
    CHECK(momentOf("a/0005_left_x.png", "{}_left*") == "0005");
    CHECK(momentOf("run/0001/left.png", "{}/*") == "0001");
    CHECK(momentOf("a/left.png", "right{}").empty());
    CHECK(momentOf("a/left.png", "left{}").empty());
}

TEST_CASE("Files of equal names are told from each other by their folders", "[view_names]")
{
    CHECK(viewNames({"a/left01.png", "b/left02.png"}) == Names{"left01", "left02"});
    CHECK(viewNames({"run/0001/left.png", "run/0002/left.png"}) == Names{"0001/left", "0002/left"});
    CHECK(viewNames({"0001/left.png", "0002/left.jpg"}) == Names{"0001/left", "0002/left"});
    CHECK(viewNames({"left.png", "left.jpg"}) == Names{"left", "left"});
}
