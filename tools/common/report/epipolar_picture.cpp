// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/epipolar_picture.hpp"
#include "report/drawing.hpp"

#include <opencv2/imgproc.hpp>
#include <algorithm>

namespace tools {

using cv::Point2d;

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
                                           pair.extrinsics[1].T, depth, lines);
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
