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

void drawRing(cv::Mat& picture, const Point2d& centre, const cv::Scalar& colour, double radius)
{
    if (!isFar(centre))
        cv::circle(picture, fixedPoint(centre), cvRound(radius*(1 << SHIFT)), colour, 1, cv::LINE_AA, SHIFT);
}

void drawCaption(cv::Mat& picture, const std::string& text, const Point& corner)
{
    const double scale = 0.55;
    int baseline = 0;
    const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &baseline);
    cv::rectangle(picture, cv::Rect(corner.x - 6, corner.y - size.height - 6, size.width + 12, size.height + baseline + 10),
                  cv::Scalar::all(20), cv::FILLED);
    cv::putText(picture, text, corner, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar::all(235), 1, cv::LINE_AA);
}

} // namespace tools
