// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/largest_rectangle.hpp"

namespace cv { namespace refract {

Rect2d largestRectangle(const Point2d& seed, const Rect2d& limits, std::vector<Point2d> points)
{
    std::sort(points.begin(), points.end(), [](const Point2d& a, const Point2d& b) { return a.y < b.y; });
    const auto below = std::lower_bound(points.begin(), points.end(), seed, [](const Point2d& a, const Point2d& b) { return a.y < b.y; });
    const Point2d end = limits.br();
    Rect2d best;
    const auto consider = [&](double left, double top, double right, double bottom)
    {
        if ((right - left)*(bottom - top) > best.area())
            best = Rect2d(left, top, right - left, bottom - top);
    };
    // Down from each top, the sides come in by the points that are passed.
    double leftAbove = limits.x, rightAbove = end.x;
    const auto narrow = [&](const Point2d& p, double& left, double& right)
    {
        if (p.x <= seed.x)
            left = std::max(left, p.x);
        else
            right = std::min(right, p.x);
    };
    for (auto top = below;;)
    {
        double left = leftAbove, right = rightAbove;
        const double y = top == points.begin() ? limits.y : std::max(limits.y, (top - 1)->y);
        for (auto p = below; p != points.end() && p->y < end.y; ++p)
        {
            consider(left, y, right, p->y);
            narrow(*p, left, right);
        }
        consider(left, y, right, end.y);
        if (top == points.begin() || (top - 1)->y <= limits.y)
            return best;
        --top;
        narrow(*top, leftAbove, rightAbove);
    }
}

}} // namespace
