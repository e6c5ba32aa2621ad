// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Lines to a part of a pixel: position and stated error against lines that were drawn.
#include "laser/ridges.hpp"
#include "scenes.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>
#include <iostream>

using namespace cv;
using namespace tools;

namespace {

const double NOISE = 0.005*255.;

struct Line
{
    Point2d through;
    Vec2d normal;
    double width, amplitude, most;

    double distance(const Point2d& p) const { return normal.dot(Vec2d(p - through)); }
};

Line randomLine(scenes::Random& random, double width, double most = 255.)
{
    const double angle = random.uniform(0, CV_PI);
    return {Point2d(random.uniform(140, 180), random.uniform(100, 140)), Vec2d(std::cos(angle), std::sin(angle)), width,
            random.uniform(60, 120), most};
}

Mat drawn(const Line& line, scenes::Random& random, double noise = NOISE)
{
    Mat image(240, 320, CV_32F);
    for (int y = 0; y < image.rows; y++)
        for (int x = 0; x < image.cols; x++)
        {
            const double t = line.distance(Point2d(x, y))/line.width;
            const double value = std::min(line.most, 20 + line.amplitude*std::exp(-0.5*t*t)) + random.normal(noise);
            image.at<float>(y, x) = saturate_cast<uchar>(value);
        }
    return image;
}

struct Errors
{
    double squares = 0., ratios = 0.;
    int count = 0, outliers = 0, covered = 0;
};

void add(const Line& line, const std::vector<RidgePoint>& ridges, Errors& e)
{
    for (const RidgePoint& p : ridges)
    {
        const double off = line.distance(p.pixel);
        if (std::abs(off) > 20.)        // noise, far from it
            continue;
        e.outliers += std::abs(off) > 1.;
        if (std::abs(off) > 1.)
            continue;
        e.squares += off*off;
        e.ratios += std::pow(off/p.sigma, 2);
        e.count++;
    }
}

} // namespace

TEST_CASE("Ridges are where the line is, within their standard deviation", "[laser][ridges]")
{
    scenes::Random random(2901);
    std::cout << "seed " << scenes::seed() << '\n';
    for (double fullWidth : {3., 4., 5.5, 8.})          // at half of its height
    {
        Errors e;
        const double width = fullWidth/2.3548;
        for (int trial = 0; trial < 12; trial++)
        {
            const Line line = randomLine(random, width);
            add(line, findRidges(drawn(line, random), width, NOISE), e);
        }
        const double rms = std::sqrt(e.squares/e.count), ratio = std::sqrt(e.ratios/e.count);
        std::cout << "[numbers] laser line " << fullWidth << " px wide, 0.5 % noise: " << rms << " px RMS, " << ratio
                  << " x stated, outliers " << e.outliers << " of " << e.count << '\n';
        CAPTURE(fullWidth);
        CHECK(e.count > 12*200);
        CHECK(rms < 0.05);
        CHECK(ratio > 0.9);
        CHECK(ratio < 1.1);
        CHECK(e.outliers == 0);
    }
}

TEST_CASE("A saturated line has its middle where it was", "[laser][ridges]")
{
    scenes::Random random(2902);
    Errors e;
    for (int trial = 0; trial < 10; trial++)
    {
        const Line line = randomLine(random, 2.5, 70.);         // flat over most of its width
        add(line, findRidges(drawn(line, random), 2.5, NOISE), e);
    }
    CHECK(e.outliers == 0);
    CHECK(std::sqrt(e.squares/e.count) < 0.1);
}

TEST_CASE("The width of a line and the noise are those that were drawn", "[laser][ridges]")
{
    scenes::Random random(2903);
    for (double width : {1.1, 2., 4.})
    {
        const Line line = randomLine(random, width);
        const Mat image = drawn(line, random);
        std::vector<Point2d> pixels;
        for (const RidgePoint& p : findRidges(image, 1.5, NOISE))
            if (std::abs(line.distance(p.pixel)) < 1.)
                pixels.push_back(p.pixel);
        CAPTURE(width);
        CHECK(scaleOfLine(image, pixels) == Approx(width).epsilon(0.3));
        CHECK(noiseOf(image) == Approx(NOISE).epsilon(0.1));
    }
    CHECK(scaleOfLine(Mat::zeros(10, 10, CV_32F), {}) == 0.);
}

TEST_CASE("Steps are no ridges, and neither is an even image", "[laser][ridges]")
{
    Mat step(200, 200, CV_32F, Scalar(20));
    step(Rect(100, 0, 100, 200)).setTo(200);
    GaussianBlur(step, step, Size(), 0.8);
    CHECK(findRidges(step, 1.5, 0.3).empty());
    CHECK(findRidges(Mat(50, 50, CV_32F, Scalar(255)), 1.5, 0.3).empty());
    CHECK(findRidges(Mat(2, 2, CV_32F, Scalar(1)), 1.5, 0.3).empty());
}
