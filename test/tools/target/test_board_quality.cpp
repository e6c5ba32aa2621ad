// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Sharpness and exposure of a board in an image, against boards that are blurred and exposed by known amounts.
#include "target/april_grid.hpp"
#include "target/board_quality.hpp"
#include "drawn_board.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>

using namespace tools;

namespace {

//! From 10 to 90 % of an edge that a Gaussian blurs, a pixel's area (1/12) and the mean of two pixels, as a line is sampled (1/4).
double widthOf(double sigma) { return 2.563*std::sqrt(sigma*sigma + 1./12 + 1./4); }

BoardQuality qualityOf(const cv::Mat& image, const DrawnBoard& board)
{
    return boardQuality(image, board.corners, board.target());
}

cv::Mat blurred(const cv::Mat& image, double sigmaX, double sigmaY)
{
    cv::Mat result;
    cv::GaussianBlur(image, result, cv::Size(), sigmaX, sigmaY);
    return result;
}

} // namespace

TEST_CASE("The width of edges is that of their blur", "[board quality]")
{
    const DrawnBoard board({7, 6}, 40., 0.);
    for (const double sigma : {1., 2., 4.})
    {
        const BoardQuality quality = qualityOf(blurred(board.image, sigma, sigma), board);
        CAPTURE(sigma, quality.words());
        for (int i : {0, 1})
            CHECK(quality.edgeWidth[i] == Approx(widthOf(sigma)).epsilon(0.06));
        CHECK(quality.complaint().empty() == (sigma < 2));
        CHECK(quality.saturated == 0);
        CHECK(quality.contrast == Approx(170).epsilon(0.05));
    }
    const BoardQuality sharp = qualityOf(board.image, board);
    CHECK(sharp.worstEdge() < 2);
    CHECK(sharp.complaint().empty());
}

TEST_CASE("Noise beside an edge does not widen it", "[board quality]")
{
    const DrawnBoard board({7, 6}, 80., 0.);
    cv::Mat image, noise(board.image.size(), CV_32F);
    blurred(board.image, 0.7, 0.7).convertTo(image, CV_32F, 0.3, 60);
    cv::RNG random(17);
    random.fill(noise, cv::RNG::NORMAL, 0., 3.);
    cv::Mat(image + noise).convertTo(image, CV_8U);
    const BoardQuality quality = qualityOf(image, board);
    CAPTURE(quality.words());
    CHECK(quality.contrast == Approx(51).epsilon(0.1));
    CHECK(quality.worstEdge() < 1.5*widthOf(0.7));
    CHECK(quality.complaint().empty());
}

TEST_CASE("A board that moves is blurred in one direction, also when it is turned", "[board quality]")
{
    for (const double degrees : {0., 90., 180.})
    {
        const DrawnBoard board({7, 6}, 40., degrees);
        const BoardQuality quality = qualityOf(blurred(board.image, 5, 0.7), board);
        CAPTURE(degrees, quality.words());
        CHECK(quality.complaint().find("one direction") != std::string::npos);
    }
}

TEST_CASE("What is cut off at either end of the scale, and a faint board, are told", "[board quality]")
{
    const DrawnBoard board({7, 6}, 40., 20.);
    const cv::Mat soft = blurred(board.image, 0.7, 0.7);
    cv::Mat bright, dim;
    soft.convertTo(bright, CV_8U, 2);                   // white would be 400
    soft.convertTo(dim, CV_8U, 0.15);
    const BoardQuality over = qualityOf(bright, board), under = qualityOf(dim, board);
    CAPTURE(over.words(), under.words());
    CHECK(over.saturated == Approx(0.5).margin(0.1));   // every other square
    CHECK(over.complaint().find("overexposed") != std::string::npos);
    CHECK(under.complaint().find("more light") != std::string::npos);
    cv::Mat black = soft - 40;
    CHECK(qualityOf(black, board).dark == Approx(0.5).margin(0.1));
    CHECK(qualityOf(black, board).complaint().empty());     // black squares may be black
}

TEST_CASE("Points that were not seen, or none at all, spoil nothing", "[board quality]")
{
    const DrawnBoard board({7, 6}, 40., 0.);
    std::vector<cv::Point2d> points = board.corners;
    for (size_t i = 0; i < points.size(); i += 3)
        points[i] = cv::Point2d(NAN, NAN);
    CHECK(boardQuality(board.image, points, board.target()).worstEdge() < 2);
    std::fill(points.begin() + 1, points.end(), cv::Point2d(NAN, NAN));
    const BoardQuality none = boardQuality(board.image, points, board.target());
    CHECK(std::isnan(none.worstEdge()));
    CHECK(none.words().find("nan") == std::string::npos);
}

TEST_CASE("The edges of an AprilGrid are those of its tags, whatever is beyond the gap between two", "[board quality][aprilgrid]")
{
    const int SIDE = 100;
    for (const double spacing : {0.15, 0.3, 1.})
        for (const double sigma : {1., 2.})
        {
            TargetOptions options;
            options.pattern = "aprilgrid";
            options.size = "5x4";
            options.square = SIDE;
            options.tagSpacing = spacing;
            const Target target(options);
            cv::Mat image = 30 + drawAprilGrid(cv::Size(5, 4), spacing, SIDE)*(170./255);
            std::vector<cv::Point2d> points;
            for (const cv::Point3d& p : target.objectPoints())
                points.emplace_back(p.x + cvRound(spacing*SIDE) - 0.5, p.y + cvRound(spacing*SIDE) - 0.5);
            const BoardQuality quality = boardQuality(blurred(image, sigma, sigma), points, target);
            CAPTURE(spacing, sigma, quality.words(), quality.contrast);
            for (int i : {0, 1})
                CHECK(quality.edgeWidth[i] == Approx(widthOf(sigma)).epsilon(0.1));
            CHECK(quality.contrast == Approx(170).epsilon(0.1));
        }
}
