// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/refine_dots.hpp"

#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;

namespace tools {

namespace {

DotImage dotOf(const RotatedRect& box)
{
    const double angle = box.angle*CV_PI/180;
    const Matx22d turn(std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle));
    return {Point2d(box.center), Matx22d(2/box.size.width, 0, 0, 2/box.size.height)*turn};
}

//! Brightness that changes evenly over a part of the image: the sums of a least-squares fit, and its value.
struct Plane
{
    Matx33d sum;
    Vec3d right, coefficients;
    void add(const Point2d& d, double value)
    {
        const Vec3d row(1, d.x, d.y);
        sum += row*row.t();
        right += value*row;
    }
    bool solve() { return cv::solve(sum, right, coefficients, DECOMP_CHOLESKY); }
    double at(const Point2d& d) const { return coefficients.dot(Vec3d(1, d.x, d.y)); }
};

//! How much brighter the pixels of a part of the image are than half-way between inside and outside; empty if that has no meaning.
Mat_<float> overHalf(const Mat& grey, const Rect& part, const DotImage& edge, double reach)
{
    const double INSIDE = 0.8, OUTSIDE = 1.1, BLUR = 1.5/edge.radius();
    Plane inside, outside;
    const auto placeOf = [&](int y, int x) { return Point2d(part.x + x, part.y + y) - edge.centre; };
    for (int y = 0; y < part.height; y++)
        for (int x = 0; x < part.width; x++)
        {
            const double out = edge.out(Point2d(part.x + x, part.y + y)), value = grey.at<uchar>(part.y + y, part.x + x);
            if (out < INSIDE - BLUR)
                inside.add(placeOf(y, x), value);
            if (out > OUTSIDE + BLUR && out < reach - BLUR)
                outside.add(placeOf(y, x), value);
        }
    if (!inside.solve() || !outside.solve())
        return {};
    Mat_<float> over(part.size());
    for (int y = 0; y < part.height; y++)
        for (int x = 0; x < part.width; x++)
            over(y, x) = (float)(grey.at<uchar>(part.y + y, part.x + x) - 0.5*(inside.at(placeOf(y, x)) + outside.at(placeOf(y, x))));
    return over;
}

//! Where the sign changes between neighbours, near the edge as it is thought to be.
std::vector<Point2f> crossings(const Mat_<float>& over, const Point& corner, const DotImage& edge, double reach)
{
    const double NEAREST = 0.6;
    std::vector<Point2f> points;
    const auto consider = [&](int y, int x, int dy, int dx) {
        const float a = over(y, x), b = over(y + dy, x + dx);
        if ((a > 0) == (b > 0))
            return;
        const Point2f p(x + dx*a/(a - b), y + dy*a/(a - b));
        const double out = edge.out(Point2d(p) + Point2d(corner));
        if (out > NEAREST && out < 0.5*(1 + reach))
            points.push_back(p);
    };
    for (int y = 0; y + 1 < over.rows; y++)
        for (int x = 0; x + 1 < over.cols; x++)
        {
            consider(y, x, 0, 1);
            consider(y, x, 1, 0);
        }
    return points;
}

DotImage refined(const Mat& grey, const DotImage& dot, double reach)
{
    const size_t FEWEST = 12;
    const double FARTHEST = 0.2, RESIZED = 1.5;     // how far it may move, in radii, and grow or shrink
    const Matx22d back = dot.toCircle.inv();
    const Point2d half(reach*norm(back.row(0)), reach*norm(back.row(1)));
    const Rect part = Rect(Point(cvFloor(dot.centre.x - half.x), cvFloor(dot.centre.y - half.y)),
                           Point(cvCeil(dot.centre.x + half.x) + 1, cvCeil(dot.centre.y + half.y) + 1)) & Rect(Point(), grey.size());
    DotImage edge = dot;
    for (int round = 0; round < 3; round++)
    {
        const Mat_<float> over = overHalf(grey, part, edge, reach);
        const std::vector<Point2f> points = over.empty() ? std::vector<Point2f>() : crossings(over, part.tl(), edge, reach);
        if (points.size() < FEWEST)
            return dot;
        edge = dotOf(fitEllipseDirect(points));
        edge.centre += Point2d(part.tl());
        const double growth = edge.radius()/dot.radius();
        if (!(dot.out(edge.centre) < FARTHEST) || !(growth < RESIZED && growth > 1/RESIZED))
            return dot;
    }
    return edge;
}

} // namespace

void refineDots(const Mat& grey, std::vector<DotImage>& dots, const std::vector<double>& reach)
{
    const double WIDE = 1.6;
    CV_Assert(grey.type() == CV_8U && reach.size() == dots.size());
    for (size_t i = 0; i < dots.size(); i++)
        dots[i] = refined(grey, dots[i], std::min(WIDE, reach[i]));
}

} // namespace tools
