// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Corners to sub-pixels, also where something that is not the board is near.
#include "scenes.hpp"
#include "target/chessboard.hpp"
#include "target/refine_points.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>
#include <cmath>

using namespace cv;
using namespace tools;

namespace {

const Point2d FIRST(60.3, 50.6);
const double SIDE = 16;
const Size CORNERS(5, 4);

//! Upright squares, the outermost at the left cut to `cut` pixels; blur and noise as the bundled images have them.
Mat board(double cut, scenes::Random& random)
{
    const int FINE = 8;
    Mat fine(140*FINE, 180*FINE, CV_32F);
    for (int y = 0; y < fine.rows; y++)
        for (int x = 0; x < fine.cols; x++)
        {
            const Point2d p(((x + 0.5)/FINE - 0.5 - FIRST.x)/SIDE, ((y + 0.5)/FINE - 0.5 - FIRST.y)/SIDE);
            const bool beyond = p.x < -cut/SIDE || p.x > CORNERS.width || p.y < -1 || p.y > CORNERS.height;
            fine.at<float>(y, x) = beyond ? 110.f : (cvFloor(p.x) + cvFloor(p.y)) % 2 ? 205.f : 35.f;
        }
    Mat grey, image;
    resize(fine, grey, Size(), 1./FINE, 1./FINE, INTER_AREA);
    GaussianBlur(grey, grey, Size(), 0.7);
    for (auto it = grey.begin<float>(); it != grey.end<float>(); it++)
        *it += (float)random.normal(1.5);
    grey.convertTo(image, CV_8U);
    return image;
}

//! Of the corners beside the cut squares, and of the others.
std::pair<double, double> largestErrors(const Mat& grey, scenes::Random& random)
{
    std::vector<Point2f> corners;
    std::vector<Point2d> exact;
    for (int row = 0; row < CORNERS.height; row++)
        for (int column = 0; column < CORNERS.width; column++)
        {
            exact.push_back(FIRST + SIDE*Point2d(column, row));
            corners.emplace_back((float)(exact.back().x + random.uniform(-0.3, 0.3)),
                                 (float)(exact.back().y + random.uniform(-0.3, 0.3)));
        }
    refineCorners(grey, corners, 0.35);
    std::pair<double, double> errors;
    for (size_t i = 0; i < exact.size(); i++)
    {
        double& largest = i % CORNERS.width ? errors.second : errors.first;
        largest = std::max(largest, norm(Point2d(corners[i]) - exact[i]));
    }
    return errors;
}

} // namespace

TEST_CASE("A corner beside a square that is cut is as good as others", "[refine_corners]")
{
    scenes::Random random(870);
    for (double cut : {16., 6.5, 5.5, 4.5})
    {
        CAPTURE(cut);
        const std::pair<double, double> errors = largestErrors(board(cut, random), random);
        CHECK(errors.second < 0.06);
        CHECK(errors.first < 0.12);
    }
}

TEST_CASE("Noise beside a board that a wide-angle lens bends does not hold up the search for it", "[refine_corners]")
{
    cv::Mat image(375, 500, CV_8U);
    for (int v = 0; v < image.rows; v++)
        for (int u = 0; u < image.cols; u++)
        {
            const double x = (u - 250)/250., y = (v - 187)/250., bent = 1 + 0.8*(x*x + y*y);
            const bool isDark = ((int)std::floor(4*(x*bent + 3)) + (int)std::floor(4*(y*bent + 3))) % 2 != 0;
            image.at<uchar>(v, u) = std::abs(x*bent) < 0.9 && std::abs(y*bent) < 0.68 && isDark ? 40 : 210;
        }
    cv::Mat noise(image.size(), CV_16S), sum;
    cv::RNG(1).fill(noise, cv::RNG::NORMAL, 0, 8);
    cv::add(image, noise, image, cv::noArray(), CV_8U);
    CHECK(detectChessboard(image, cv::Size(9, 6), nullptr).empty());        // it has 7 x 5; in minutes if OpenCV looks at each speck
}
