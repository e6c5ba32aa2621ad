// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "math/quantile.hpp"
#include "stereo/depth_picture.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <cmath>

using namespace tools;

namespace {

const float NONE = std::numeric_limits<float>::quiet_NaN();

int brightness(const cv::Mat& picture, int y, int x)
{
    const cv::Vec3b c = picture.at<cv::Vec3b>(y, x);
    return c[0] + c[1] + c[2];
}

//! Depth that grows from left to right; the left half of the upper half is unknown.
cv::Mat ramp(double from, double to)
{
    cv::Mat depth(480, 640, CV_32F);
    for (int y = 0; y < depth.rows; y++)
        for (int x = 0; x < depth.cols; x++)
            depth.at<float>(y, x) = (float)(from + (to - from)*x/(depth.cols - 1));
    depth(cv::Rect(0, 0, 320, 240)).setTo(NONE);
    return depth;
}

//! Where the picture's scale bar has its colours.
int columnOfBar(const cv::Mat& picture)
{
    for (int x = 640; x < picture.cols; x++)
    {
        const cv::Vec3b c = picture.at<cv::Vec3b>(picture.rows/2, x);
        if (c[0] != c[1] || c[1] != c[2])
            return x;
    }
    return -1;
}

} // namespace

TEST_CASE("Ticks are round, in the range, and about as many as asked for", "[tools][stereo][picture]")
{
    CHECK(ticksOf(471, 1131, 8) == std::vector<double>{500, 600, 700, 800, 900, 1000, 1100});
    CHECK(ticksOf(0, 10, 5) == std::vector<double>{0, 2, 4, 6, 8, 10});
    CHECK(ticksOf(99, 101, 5) == std::vector<double>{99, 99.5, 100, 100.5, 101});
    for (const double size : {1e-6, 0.3, 1., 7.7, 1234., 1e9})
        for (const int about : {2, 5, 10})
        {
            const std::vector<double> ticks = ticksOf(3*size, 4*size, about);
            CAPTURE(size, about);
            CHECK((int)ticks.size() >= (about + 1)/3);
            CHECK((int)ticks.size() <= about + 1);
            for (const double tick : ticks)
                CHECK((tick >= 3*size*(1 - 1e-9) && tick <= 4*size*(1 + 1e-9)));
        }
}

TEST_CASE("Near is bright, unknown is black, and the image keeps its place", "[tools][stereo][picture]")
{
    const cv::Mat picture = depthPicture(ramp(500, 900), "mm");
    REQUIRE(picture.type() == CV_8UC3);
    CHECK(picture.rows == 480);
    CHECK(picture.cols > 640 + 40);
    CHECK(picture.cols < 640 + 200);
    CHECK(depthPicture(ramp(500, 900), "millimetres").cols > picture.cols);       // the title has its place
    CHECK(brightness(picture, 100, 100) == 0);
    CHECK(brightness(picture, 300, 20) > brightness(picture, 300, 320));
    CHECK(brightness(picture, 300, 320) > brightness(picture, 300, 620));
    CHECK(brightness(picture, 300, 620) > 0);       // far is not unknown
}

TEST_CASE("The scale bar has the image's colours", "[tools][stereo][picture]")
{
    const cv::Mat depth = ramp(500, 900), picture = depthPicture(depth, "mm");
    const int column = columnOfBar(picture);
    REQUIRE(column > 0);
    int top = 0, bottom = picture.rows - 1;
    const auto isColoured = [&](int y) {
        const cv::Vec3b c = picture.at<cv::Vec3b>(y, column);
        return c[0] != c[1] || c[1] != c[2];
    };
    while (!isColoured(top))
        top++;
    while (!isColoured(bottom))
        bottom--;
    CHECK(bottom - top > 300);
    const std::vector<float> sorted = sortedDepths(depth);
    const double near = cv::refract::quantile(sorted, 0.01), far = cv::refract::quantile(sorted, 0.99);
    for (const double part : {0.1, 0.5, 0.9})       // of the way from far, at the top, to near
    {
        const double z = far + part*(near - far);
        const int x = cvRound((z - 500)/400*639), y = top + cvRound(part*(bottom - top));
        CHECK(cv::norm(picture.at<cv::Vec3b>(400, x), picture.at<cv::Vec3b>(y, column), cv::NORM_INF) <= 6);
    }
}

TEST_CASE("A picture's scale ignores a few wild depths, and stands one depth or none", "[tools][stereo][picture]")
{
    cv::Mat depth = ramp(500, 900);
    const cv::Mat before = depthPicture(depth, "");
    depth(cv::Rect(600, 400, 20, 20)).setTo(1e6);
    depth(cv::Rect(600, 440, 20, 20)).setTo(1);
    depth.at<float>(300, 600) = std::numeric_limits<float>::infinity();
    const cv::Mat after = depthPicture(depth, "");
    REQUIRE(after.cols == before.cols);
    CHECK(cv::norm(after(cv::Rect(0, 0, 590, 480)), before(cv::Rect(0, 0, 590, 480)), cv::NORM_INF) < 12);
    for (const float one : {0.5f, 600.f, NONE})
    {
        const cv::Mat flat(48, 64, CV_32F, cv::Scalar(one));
        CHECK(depthPicture(flat, "mm").rows == 48);
    }
}

TEST_CASE("A rectified pair is shown with lines along which partners lie", "[tools][stereo][picture]")
{
    const cv::Mat one(60, 80, CV_8U, cv::Scalar(100)), two(60, 80, CV_8UC3, cv::Scalar::all(100));
    const cv::Mat flat = sideBySide(one, two, false), upright = sideBySide(one, two, true);
    CHECK(flat.size() == cv::Size(168, 60));
    CHECK(upright.size() == cv::Size(80, 128));
    const cv::Vec3b grey(100, 100, 100);
    int rows = 0, columns = 0;
    for (int y = 0; y < flat.rows; y++)
        rows += flat.at<cv::Vec3b>(y, 10) != grey && flat.at<cv::Vec3b>(y, 150) != grey;
    for (int x = 0; x < upright.cols; x++)
        columns += upright.at<cv::Vec3b>(10, x) != grey && upright.at<cv::Vec3b>(120, x) != grey;
    CHECK(rows >= 16);
    CHECK(columns >= 16);

    const TemporaryFolder folder;
    cv::Mat disparity(60, 80, CV_32F, cv::Scalar(12.25));
    disparity.at<float>(3, 4) = NONE;
    writeRectified(folder / "a_", one, two, disparity, false);
    CHECK(folder.count() == 4);
    const cv::Mat read = cv::imread(rectifiedFiles(folder / "a_")[3], cv::IMREAD_UNCHANGED);
    REQUIRE(read.type() == CV_32F);
    CHECK(read.at<float>(0, 0) == 12.25f);
    CHECK(std::isnan(read.at<float>(3, 4)));
}
