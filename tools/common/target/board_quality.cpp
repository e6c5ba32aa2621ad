// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/board_quality.hpp"
#include "console/median.hpp"
#include "target/april_grid.hpp"

#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;

namespace tools {

namespace {

const double WIDE_EDGE = 5.;            // px: a Gaussian of two pixels; corners lose half of their precision
const double MOVED = 1.8;               // edges of one direction are wider by so much
const double FAINT = 40.;               // grey levels
const double CLIPPED = 0.05;            // of the board: white that bleeds over the edges
const int WHITE = 254, BLACK = 1;
const double LEAST_STEP = 6.;           // px between neighbours, for an edge to be seen between them
const int SAMPLES_A_PIXEL = 2;

//! The brightness along a line that crosses one edge.
std::vector<double> profile(const Mat& grey, const Point2d& from, const Point2d& to)
{
    const int count = std::max(8, (int)std::lround(SAMPLES_A_PIXEL*norm(to - from)));
    Mat map(1, count, CV_32FC2), values;
    for (int i = 0; i < count; i++)
        map.at<Vec2f>(i) = Vec2f(Vec2d(from + (to - from)*((double)i/(count - 1))));
    remap(grey, values, map, noArray(), INTER_LINEAR, BORDER_REPLICATE);
    values.convertTo(values, CV_64F);
    return std::vector<double>(values.begin<double>(), values.end<double>());
}

struct Edge
{
    double width, contrast;
};

//! From 10 to 90 % between the levels at both ends of the profile.
Edge edgeOf(const std::vector<double>& values, double length)
{
    const size_t end = std::max<size_t>(2, values.size()/6);
    const double first = median(std::vector<double>(values.begin(), values.begin() + (long)end));
    const double last = median(std::vector<double>(values.end() - (long)end, values.end())), step = last - first;
    // Where a level is passed: the last time from this side for the lower, the first time for the upper.
    const auto passed = [&](double share) {
        const double level = first + share*step;
        for (size_t i = 1; i < values.size(); i++)
            if ((values[i] - level)*step >= 0)
            {
                const double before = values[i - 1], rise = values[i] - before;
                return (double)i - (rise != 0 ? std::clamp((values[i] - level)/rise, 0., 1.) : 0.);
            }
        return (double)values.size();
    };
    return {(passed(0.9) - passed(0.1))*length/(double)(values.size() - 1), std::abs(step)};
}

//! Whether there is an edge between two neighbours that tells: between two tags it is short.
bool hasEdge(const std::pair<int, int>& pair, const Target& target)
{
    const int columns = target.size().width;
    const int place = pair.second == pair.first + 1 ? pair.first % columns : pair.first/columns;
    return target.pattern() != Target::APRILGRID || place % 2 == 0;
}

//! How far from an edge between two neighbours nothing else comes, as a part of their distance.
double reachFrom(const Target& target)
{
    if (target.pattern() == Target::APRILGRID)          // the tag's border, and the gap to the next one
        return 0.8*std::min(APRIL_BORDER, target.tagSpacing());
    // As far as the square's middle; a marker leaves less room.
    return target.pattern() == Target::CHARUCO ? 0.4*(1 - target.marker()/target.square()) : 0.4;
}

//! The line that crosses the edge between two neighbours of the target: a square's side, or the rim of the first's dot.
std::pair<Point2d, Point2d> across(const Point2d& a, const Point2d& b, const Target& target)
{
    const Point2d step = b - a, middle = 0.5*(a + b);
    if (target.pattern() == Target::CIRCLES || target.pattern() == Target::ACIRCLES)
        return {a, middle};
    const double reach = reachFrom(target);
    const Point2d normal(-step.y, step.x);
    return {middle - reach*normal, middle + reach*normal};
}

//! Shares of the pixels on the board.
void countClipped(const Mat& grey, const std::vector<Point2d>& points, BoardQuality& quality)
{
    std::vector<Point2f> found;
    for (const Point2d& p : points)
        if (seen(p))
            found.emplace_back(p);
    if (found.size() < 3)
        return;
    std::vector<Point2f> hull;
    convexHull(found, hull);
    Mat mask(grey.size(), CV_8U, Scalar(0));
    fillConvexPoly(mask, std::vector<Point>(hull.begin(), hull.end()), Scalar(255));
    const double all = std::max(1, countNonZero(mask));
    quality.saturated = countNonZero(mask & (grey >= WHITE))/all;
    quality.dark = countNonZero(mask & (grey <= BLACK))/all;
}

std::string percent(double share) { return format("%.0f %%", 100*share); }

} // namespace

BoardQuality boardQuality(const Mat& grey, const std::vector<Point2d>& points, const Target& target)
{
    BoardQuality quality = {};
    std::vector<double> widths[2], contrasts;
    for (const auto& pair : target.neighbours())
    {
        const Point2d &a = points[pair.first], &b = points[pair.second];
        if (!hasEdge(pair, target) || !seen(a) || !seen(b) || norm(b - a) < LEAST_STEP)
            continue;
        const auto line = across(a, b, target);
        const Edge edge = edgeOf(profile(grey, line.first, line.second), norm(line.second - line.first));
        widths[pair.second == pair.first + 1].push_back(edge.width);
        contrasts.push_back(edge.contrast);
    }
    for (int i : {0, 1})
        quality.edgeWidth[i] = median(widths[i]);
    quality.contrast = median(contrasts);
    countClipped(grey, points, quality);
    return quality;
}

double BoardQuality::worstEdge() const { return std::fmax(edgeWidth[0], edgeWidth[1]); }

std::string BoardQuality::words() const
{
    return (std::isnan(worstEdge()) ? "" : format("edges %.1f px, ", worstEdge())) + percent(saturated) + " saturated, " + percent(dark)
           + " black";
}

std::string BoardQuality::complaint() const
{
    const double narrow = std::fmin(edgeWidth[0], edgeWidth[1]);
    if (worstEdge() > WIDE_EDGE && worstEdge() > MOVED*narrow)
        return "blurred in one direction: hold the board still, or expose for a shorter time";
    if (worstEdge() > WIDE_EDGE)
        return "blurred: focus, or hold the board still";
    if (saturated > CLIPPED)
        return "overexposed: expose for a shorter time, as white that is cut off moves the edges";
    if (contrast < FAINT)
        return format("dark and light differ by %.0f of 255 levels: more light, or no reflections on the board", contrast);
    return "";
}

} // namespace tools
