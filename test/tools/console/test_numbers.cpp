// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Numbers in options and point files mean the same where people write a decimal comma.
#include "console/numbers.hpp"
#include "console/options.hpp"
#include "console/csv.hpp"
#include "german.hpp"
#include "target/detected_images.hpp"
#include <cmath>
#include <fstream>

using namespace tools;

namespace {

void checkAll()
{
    double number = 0;
    CHECK((parseNumber("1.5", number) && number == 1.5));
    CHECK((parseNumber("+1.5e2", number) && number == 150));
    CHECK((parseNumber("nan", number) && std::isnan(number)));
    for (const char* wrong : {"", "1,5", "1.5x", " 1.5", "+-1", "."})
        CHECK(!parseNumber(wrong, number));
    CHECK(parseNumbers("0.1,20.5, 3", "--x") == std::vector<double>{0.1, 20.5, 3});
    CHECK(parseSize("1280x1024", "--image-size") == cv::Size(1280, 1024));
    std::string option;
    OptionParser parser;
    parser.add("--x", option, "").check(moreThanZero());
    parser.parse({"--x=1.5"});
    CHECK(option == "1.5");

    const TemporaryFolder folder;
    std::ofstream(folder / "corners.vnl") << "# filename x y level\na.png 100.25 200.5 0\na.png 1.25 2.5 -\n";
    const auto images = readCornersVnl(folder / "corners.vnl", 2);
    REQUIRE(images.size() == 1);
    CHECK(images[0].second[0] == cv::Point2d(100.25, 200.5));
    std::ofstream(folder / "points.csv") << "u,v\n100.25,200.5\nnan,nan\n";
    const auto pixels = readPixels(folder / "points.csv");
    REQUIRE(pixels.size() == 1);
    CHECK(pixels[0] == cv::Point2d(100.25, 200.5));
}

} // namespace

TEST_CASE("Numbers are read whatever the locale", "[locale]")
{
    checkAll();
    const German german;
    checkAll();
}
