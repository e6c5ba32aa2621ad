// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/refine_points.hpp"
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;

namespace tools {

namespace {

const int LEAST_HALF = 2;
const int GRADIENT = 1;                 // pixels beyond
const double UNLIKE = 0.3;              // of the contrast: such a difference is not noise
const double FEW = 0.2;                 // of a ring's pixels: edges that are not quite where their opposites are

/* A corner looks the same turned by half a circle, and no affine map changes that; what else may be there, as the end of a board
that is cut by the border of what is seen, or a finger, does not. It begins at some distance, so rings are looked at.
@param half to that distance */
bool isPointSymmetric(const cv::Mat& grey, const cv::Point2f& corner, int half)
{
    cv::Mat patch, turned;
    cv::getRectSubPix(grey, cv::Size(2*half + 1, 2*half + 1), corner, patch);
    cv::flip(patch, turned, -1);
    double low, high;
    cv::minMaxLoc(patch, &low, &high);
    cv::absdiff(patch, turned, turned);
    const cv::Mat different = turned > UNLIKE*(high - low);
    int within = 0;                     // the rings inside
    for (int ring = 0; ring <= half; ring++)
    {
        const int side = 2*ring + 1;
        const int all = cv::countNonZero(different(cv::Rect(half - ring, half - ring, side, side)));
        if (ring > LEAST_HALF && all - within > FEW*8*ring)
            return false;
        within = all;
    }
    return true;
}

void refine(const cv::Mat& smooth, std::vector<cv::Point2f>& corners, int half)
{
    cv::cornerSubPix(smooth, corners, cv::Size(half, half), cv::Size(-1, -1),
                     cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4));
}

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

void refineCorners(const cv::Mat& grey, std::vector<cv::Point2f>& corners, double reach)
{
    double spacing = std::numeric_limits<double>::max();
    for (size_t i = 0; i < corners.size(); i++)
        for (size_t j = 0; j < i; j++)
            spacing = std::min(spacing, cv::norm(corners[i] - corners[j]));
    const int half = std::max(LEAST_HALF, std::min(11, cvFloor(reach*spacing)));
    cv::Mat smooth;
    cv::GaussianBlur(grey, smooth, cv::Size(), std::min(1., std::max(0.3, 0.02*spacing)));
    const std::vector<cv::Point2f> found = corners;
    refine(smooth, corners, half);
    for (size_t i = 0; i < corners.size(); i++)
    {
        std::vector<cv::Point2f> one = {corners[i]};
        int of = half;
        while (of >= LEAST_HALF && !isPointSymmetric(smooth, one[0], of + GRADIENT))
            if (--of >= LEAST_HALF)
            {
                one[0] = found[i];
                refine(smooth, one, of);
            }
        if (of >= LEAST_HALF)           // else a robust fit may leave it out
            corners[i] = one[0];
    }
}

void refineDots(const Mat& grey, std::vector<DotImage>& dots, const std::vector<double>& reach)
{
    const double WIDE = 1.6;
    CV_Assert(grey.type() == CV_8U && reach.size() == dots.size());
    for (size_t i = 0; i < dots.size(); i++)
        dots[i] = refined(grey, dots[i], std::min(WIDE, reach[i]));
}

} // namespace tools
