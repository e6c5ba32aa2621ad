// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// ChArUco boards of both layouts.
#include "console/failure.hpp"
#include "target/target.hpp"
#include <opencv2/imgproc.hpp>
#include <catch2/catch.hpp>

using namespace tools;
using cv::Point2d;

namespace {

const int PIXELS = 40, MARGIN = 30;     // of a square, round the board

TargetOptions board(const std::string& size, bool legacy)
{
    TargetOptions options;
    options.pattern = "charuco";
    options.size = size;
    options.square = 30;
    options.marker = 20;
    options.legacy = legacy;
    return options;
}

//! The board, from the front. That of the old layout has the squares with markers of the new one, in the order of their numbers, elsewhere.
cv::Mat picture(const std::string& size, bool legacy)
{
    const Target target(board(size, false));
    cv::Mat drawn = target.drawing(PIXELS);
    const cv::Size squares(target.size().width + 1, target.size().height + 1);
    if (legacy && squares.height % 2 == 0)
    {
        const cv::Mat all = drawn.clone();
        std::vector<cv::Rect> of[2];
        for (int y = 0; y < squares.height; y++)
            for (int x = 0; x < squares.width; x++)
                of[(x + y) % 2].push_back(cv::Rect(x*PIXELS, y*PIXELS, PIXELS, PIXELS));
        for (size_t i = 0; i < of[1].size(); i++)
            all(of[1][i]).copyTo(drawn(of[0][i]));
        for (const cv::Rect& dark : of[1])
            drawn(dark).setTo(0);
    }
    cv::copyMakeBorder(drawn, drawn, MARGIN, MARGIN, MARGIN, MARGIN, cv::BORDER_CONSTANT, 255);
    cv::GaussianBlur(drawn, drawn, cv::Size(), 1.);
    return drawn;
}

//! @param otherSize that is said; empty: that of the board
std::string failure(const std::string& size, bool drawn, bool said, const std::string& otherSize = "")
{
    try
    {
        Target(board(otherSize.empty() ? size : otherSize, said)).detect(picture(size, drawn));
        return "found";
    }
    catch (const Failure& e)
    {
        return e.what();
    }
}

} // namespace

TEST_CASE("ChArUco boards of the layout before OpenCV 4.6 are found where they are", "[charuco]")
{
    for (const char* size : {"8x5", "7x5", "8x6", "5x7"})       // squares: an even and an odd number of rows, and of columns
        for (bool legacy : {false, true})
        {
            CAPTURE(size, legacy);
            const Target target(board(size, legacy));
            const std::vector<Point2d> points = target.detect(picture(size, legacy));
            REQUIRE(points.size() == (size_t)target.count());
            double most = 0.;
            for (int i = 0; i < target.count(); i++)
            {
                const cv::Point corner(i % target.size().width + 1, i/target.size().width + 1);
                most = std::max(most, norm(points[i] - Point2d(corner*PIXELS + cv::Point(MARGIN, MARGIN)) + Point2d(0.5, 0.5)));
            }
            CHECK(most < 0.1);
        }
}

TEST_CASE("The other layout of a ChArUco board is told, and what to say of it", "[charuco]")
{
    CHECK_THAT(failure("8x5", true, false), Catch::Contains("before 4.6") && Catch::Contains("say --legacy"));
    CHECK_THAT(failure("8x5", false, true), Catch::Contains("since 4.6: leave --legacy out"));
    CHECK(failure("8x6", false, true) == "found");             // no difference
    CHECK(failure("8x6", true, false) == "found");
}

TEST_CASE("A ChArUco board of another size than --size is told by where its markers are", "[charuco]")
{
    for (bool legacy : {false, true})
    {
        CHECK_THAT(failure("8x5", legacy, legacy, "5x8"), Catch::Contains("give --size=8x5, columns before rows"));
        CHECK_THAT(failure("9x6", legacy, legacy, "6x9"), Catch::Contains("give --size=9x6, columns before rows"));
        for (const char* size : {"6x5", "8x5", "7x6", "5x6"})       // squares counted: of 6x5, the numbers of 6x7 exchanged
        {
            const std::string squares{char(size[0] + 1), 'x', char(size[2] + 1)};
            CHECK_THAT(failure(size, legacy, legacy, squares), Catch::Contains(std::string("squares, as many as --size=") + squares)
                                                                && Catch::Contains(std::string("give --size=") + size));
        }
        CHECK_THAT(failure("8x6", legacy, legacy, "7x6"), Catch::Contains("in 9 columns of squares, not in the 8 of --size=7x6"));
        CHECK(failure("8x6", legacy, legacy) == "found");
    }
}

TEST_CASE("A ChArUco board of the right columns with a marker in the first corner is told of its rows", "[charuco]")
{
    CHECK_THAT(failure("6x5", true, false, "6x6"), Catch::Contains("a marker in the first corner, which OpenCV's boards with an odd "
                                                                   "number of rows of squares do not have"));
}

TEST_CASE("A ChArUco board with more rows than --size has the same markers in the same places, and is told all the same", "[charuco]")
{
    for (const char* size : {"8x6", "8x5", "7x6", "7x5"})       // squares: an even and an odd number of rows, and of columns
        for (bool drawn : {false, true})
            for (bool said : {false, true})
                for (int fewer : {1, 2})
                {
                    CAPTURE(size, drawn, said, fewer);
                    CHECK_THAT(failure(size, drawn, said, {size[0], 'x', char(size[2] - fewer)}),
                               Catch::Contains(cv::format("has %d rows of squares or more", size[2] - '0' + 1))
                               && Catch::Contains(std::string("give --size=") + size));
                }
}
