// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Boards to print: rendered to pixels by another program and found by the detectors, they have their true size.
#include "target/board_page.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>

using namespace tools;

namespace {

TargetOptions board(const std::string& pattern, const std::string& size, double square)
{
    TargetOptions options;
    options.pattern = pattern;
    options.size = size;
    options.square = square;
    return options;
}

//! At 254 dpi: ten pixels a millimetre. Rendered twice as fine, as edges are put on whole pixels; then as soft as a camera's image.
cv::Mat render(const std::string& pdf, const std::string& name)
{
    REQUIRE(std::system(("pdftoppm -r 508 -gray -singlefile " + pdf + " " + name).c_str()) == 0);
    cv::Mat image;
    cv::resize(cv::imread(name + ".pgm", cv::IMREAD_GRAYSCALE), image, cv::Size(), 0.5, 0.5, cv::INTER_AREA);
    cv::GaussianBlur(image, image, cv::Size(), 0.7);
    return image;
}

//! Of a row or column of the target: its length in pixels over that in millimetres on paper, over ten.
double scaleOf(const std::vector<cv::Point2d>& pixels, const std::vector<cv::Point2d>& paper, size_t a, size_t b)
{
    return cv::norm(pixels[b] - pixels[a])/(10*cv::norm(paper[b] - paper[a]));
}

} // namespace

TEST_CASE("A printed board has its true size, and all of its points are found", "[board]")
{
    TargetOptions markers = board("charuco", "7x4", 25);
    markers.marker = 17;
    markers.dictionary = "DICT_5X5_100";
    const struct { TargetOptions target; double millimetres; std::string paper; } cases[] = {
        {board("chessboard", "6x5", 25), 1, "A4"}, {board("chessboard", "9x6", 0.015), 1000, "A4"}, {markers, 1, "A4"},
        {board("charuco", "6x5", 1), 25.4, "A4"}, {board("circles", "7x6", 20), 1, "A4"}, {board("acircles", "4x11", 20), 1, "A4"},
        {board("chessboard", "6x5", 39), 1, "A3"}, {board("chessboard", "11x8", 20), 1, "A4"}, {board("circles", "9x6", 23), 1, "A4"},
        {board("charuco", "7x5", 30), 1, "A4"}};            // turned by a quarter
    for (const auto& c : cases)
    {
        const TemporaryFolder folder;
        const Target target(c.target);
        const BoardPage page(target, c.millimetres, "");
        CAPTURE(c.target.pattern, c.target.size, page.paperName());
        CHECK(page.paperName() == c.paper);
        page.write(folder / "board.pdf", {"one line", "another"});
        const cv::Mat image = render(folder / "board.pdf", folder / "board");
        REQUIRE(std::abs(image.cols - 10*page.paper().width) <= 1);
        const std::vector<cv::Point2d> found = target.detect(image), paper = page.points();
        REQUIRE(found.size() == paper.size());
        double worst = 0;
        for (size_t i = 0; i < found.size(); i++)
            worst = std::max(worst, cv::norm(found[i] - (10*paper[i] - cv::Point2d(0.5, 0.5))));
        CHECK(worst < 0.15);                        // NaN, where one was not seen, fails
        const size_t columns = target.size().width, all = found.size();
        double largest = 0;
        for (size_t row = 0; row < all; row += columns)
            largest = std::max(largest, std::abs(scaleOf(found, paper, row, row + columns - 1) - 1));
        for (size_t column = 0; column < columns; column++)
            largest = std::max(largest, std::abs(scaleOf(found, paper, column, all - columns + column) - 1));
        CHECK(largest < 1e-4);
    }
}

TEST_CASE("The ruler of a board is 100 mm long", "[board]")
{
    const TemporaryFolder folder;
    const Target target(board("chessboard", "6x5", 25));
    const BoardPage page(target, 1, "A4");
    page.write(folder / "board.pdf", {});
    const cv::Mat image = render(folder / "board.pdf", folder / "board");
    // Below the board nothing is dark but the ruler.
    const cv::Mat below = image.rowRange((int)(10*(page.board().br().y + 1)), image.rows);
    std::vector<cv::Point> dark;
    cv::findNonZero(below < 128, dark);
    REQUIRE(dark.size() > 100);
    const auto ends = std::minmax_element(dark.begin(), dark.end(), [](cv::Point a, cv::Point b) { return a.x < b.x; });
    CHECK(std::abs((ends.second->x - ends.first->x + 1) - (10*BoardPage::RULER + 1.5)) <= 1);     // and half a line at both ends
}

TEST_CASE("A board as SVG has its size in points, and the same squares", "[board]")
{
    const TemporaryFolder folder;
    const Target target(board("chessboard", "6x5", 25));
    const BoardPage page(target, 1, "A4");
    page.write(folder / "board.svg", {"text"});
    std::ifstream file(folder / "board.svg");
    const std::string svg{std::istreambuf_iterator<char>(file), {}};
    std::smatch size, square;
    REQUIRE(std::regex_search(svg, size, std::regex("width=\"([0-9.]+)(pt)?\" height=\"([0-9.]+)(pt)?\"")));
    CHECK(std::stod(size[1]) == Approx(page.paper().width*72/25.4).epsilon(1e-5));
    CHECK(std::stod(size[3]) == Approx(page.paper().height*72/25.4).epsilon(1e-5));
    REQUIRE(std::regex_search(svg, square, std::regex("d=\"M ([0-9.]+) ([0-9.]+) L ([0-9.]+) ")));
    const double point = 25.4/72, quantum = point/256;
    CHECK(std::abs(std::stod(square[1])*point - page.board().x) < quantum);
    CHECK(std::abs((std::stod(square[3]) - std::stod(square[1]))*point - 25) < 2*quantum);
}

TEST_CASE("Paper is chosen by what is on it", "[board]")
{
    const Target small(board("chessboard", "3x3", 10)), large(board("chessboard", "20x9", 60));
    CHECK(BoardPage(small, 1, "").paperName() == "A4");
    CHECK(BoardPage(small, 1, "A5").paper().width == 148);
    CHECK(BoardPage(large, 1, "").paper().width > 1189);        // larger than A0: made to measure
    CHECK(BoardPage(small, 1, "200x300").paper() == cv::Size2d(200, 300));
    CHECK_THROWS_WITH(BoardPage(large, 1, "A4"), Catch::Contains("larger paper"));
    CHECK_THROWS_WITH(BoardPage(small, 1, "80x300"), Catch::Contains("needs 118x"));
    CHECK_THROWS_WITH(BoardPage(small, 1, "letter"), Catch::Contains("--paper"));
}

TEST_CASE("The paper lies as the board does, if it fits so", "[board]")
{
    const auto isAcross = [](const std::string& size, double square, const std::string& paper) {
        const Target target(board("chessboard", size, square));
        const cv::Size2d page = BoardPage(target, 1, paper).paper();
        return page.width > page.height;
    };
    CHECK(isAcross("9x6", 25, ""));
    CHECK(isAcross("9x6", 25, "A3"));
    CHECK_FALSE(isAcross("6x9", 25, "A3"));
    CHECK_FALSE(isAcross("6x9", 15, ""));
    CHECK_FALSE(isAcross("9x6", 25, "297x420"));
}
