// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/drawing.hpp"
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

namespace tools {

using cv::Point;
using cv::Point2d;

namespace {

const int SHIFT = 4;    // binary digits of sub-pixel coordinates

Point fixedPoint(const Point2d& p)
{
    return Point(cvRound(p.x*(1 << SHIFT)), cvRound(p.y*(1 << SHIFT)));
}

bool isFar(const Point2d& p)     // beyond what fixed-point coordinates hold
{
    return !(std::abs(p.x) < 1e6 && std::abs(p.y) < 1e6);
}

} // namespace

cv::Scalar colourOf(int i, int n)
{
    // Neighbours in the row get hues far apart (golden section), so that lines next to each other can be told.
    const double hue = 180.*std::fmod(i*0.6180339887498949 + 0.5/std::max(n, 1), 1.);
    cv::Mat hsv(1, 1, CV_8UC3, cv::Scalar(hue, 190, 255)), bgr;
    cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
    const cv::Vec3b c = bgr.at<cv::Vec3b>(0, 0);
    return cv::Scalar(c[0], c[1], c[2]);
}

void drawCurve(cv::Mat& picture, const std::vector<Point2d>& points, const cv::Scalar& colour, double dash)
{
    double walked = 0;
    for (size_t i = 1; i < points.size(); i++)
    {
        const Point2d from = points[i - 1], to = points[i];
        const double length = cv::norm(to - from);
        if (isFar(from) || isFar(to))
            continue;
        for (double at = 0; at < length; )
        {
            const double phase = dash > 0 ? std::fmod(walked, 2*dash) : 0;
            const double step = dash > 0 ? std::min(length - at, (phase < dash ? dash : 2*dash) - phase + 1e-9)
                                         : length;
            if (phase < dash || dash <= 0)
                cv::line(picture, fixedPoint(from + (to - from)*(at/length)),
                         fixedPoint(from + (to - from)*((at + step)/length)), colour, 1, cv::LINE_AA, SHIFT);
            at += step;
            walked += step;
        }
    }
}

//! Small ring with the point in its middle free.
static void drawRing(cv::Mat& picture, const Point2d& centre, const cv::Scalar& colour, double radius = 6.)
{
    if (!isFar(centre))
        cv::circle(picture, fixedPoint(centre), cvRound(radius*(1 << SHIFT)), colour, 1, cv::LINE_AA, SHIFT);
}

//! A line of text on a dark ground; the corner is its lower left.
static void drawCaption(cv::Mat& picture, const std::string& text, const Point& corner)
{
    const double scale = 0.55;
    int baseline = 0;
    const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &baseline);
    cv::rectangle(picture, cv::Rect(corner.x - 6, corner.y - size.height - 6, size.width + 12, size.height + baseline + 10),
                  cv::Scalar::all(20), cv::FILLED);
    cv::putText(picture, text, corner, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar::all(235), 1, cv::LINE_AA);
}

//! A little darker, so that the lines stand out.
static cv::Mat ground(const cv::Mat& grey)
{
    cv::Mat colour;
    cv::cvtColor(grey*0.75, colour, cv::COLOR_GRAY2BGR);
    return colour;
}

std::vector<Curve> curvesOf(const Calibration& pair, const std::vector<Point2d>& points, const cv::Vec2d& depth)
{
    std::vector<cv::Mat> lines;
    cv::refract::computeRefractiveEpilines(points, 1, pair.cameras[0].camera, pair.cameras[1].camera, pair.extrinsics[1].R,
                                           pair.extrinsics[1].t, depth, lines);
    std::vector<Curve> curves;
    for (const cv::Mat& line : lines)
        curves.push_back(line.empty() ? Curve() : Curve(line.begin<Point2d>(), line.end<Point2d>()));
    return curves;
}

cv::Mat epipolarPicture(const cv::Mat& grey1, const cv::Mat& grey2, const std::vector<Point2d>& points,
                        const std::vector<Point2d>& partners, const std::vector<Curve>& curves, const std::vector<Curve>& ignored)
{
    const int n = (int)points.size();
    cv::Mat left = ground(grey1), right = ground(grey2);
    for (int i = 0; i < n; i++)
    {
        drawRing(left, points[i], colourOf(i, n));
        drawCurve(right, ignored[i], colourOf(i, n)*0.8, 7.);
        drawCurve(right, curves[i], colourOf(i, n));
    }
    for (size_t i = 0; i < partners.size(); i++)
        drawRing(right, partners[i], colourOf((int)i, n));
    drawCaption(left, "image 1: points", cv::Point(12, 26));
    drawCaption(right, "image 2: solid through the windows, dashed windows ignored", cv::Point(12, 26));
    cv::Mat picture(std::max(left.rows, right.rows), left.cols + right.cols + 8, CV_8UC3, cv::Scalar::all(255));
    left.copyTo(picture(cv::Rect(cv::Point(0, 0), left.size())));
    right.copyTo(picture(cv::Rect(cv::Point(left.cols + 8, 0), right.size())));
    return picture;
}

} // namespace tools
