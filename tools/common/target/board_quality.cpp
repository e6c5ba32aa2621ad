// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/board_quality.hpp"
#include "console/numbers.hpp"
#include "math/rotation.hpp"
#include "target/april_grid.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

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
    const auto isPast = [&](size_t i, double share) { return (values[i] - first - share*step)*step >= 0; };
    const auto passed = [&](size_t i, double share) {       // between i - 1 and i
        const double rise = values[i] - values[i - 1];
        return (double)i - (rise != 0 ? std::clamp((values[i] - first - share*step)/rise, 0., 1.) : 0.);
    };
    // Where the upper level is passed for the first time, and the lower one for the last time before: noise is no edge.
    size_t upper = 1;
    while (upper + 1 < values.size() && !isPast(upper, 0.9))
        upper++;
    size_t lower = upper;
    while (lower > 1 && isPast(lower - 1, 0.1))
        lower--;
    return {(passed(upper, 0.9) - passed(lower, 0.1))*length/(double)(values.size() - 1), std::abs(step)};
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
    if (target.isDotGrid())
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

const double GUESSED_FOCAL_LENGTH = 1.2;        // in image widths; enough to tell a tilted board from one that is not
const double TILT_DEG = 12.;
const double NEAR = 0.45, FAR_OVER_NEAR = 0.7;  // of the picture; of the largest board

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

void NextView::add(const std::vector<cv::Point2d>& points)
{
    std::vector<cv::Point3f> object;
    std::vector<cv::Point2f> pixels;
    for (size_t i = 0; i < points.size(); i++)
        if (seen(points[i]))
        {
            object.emplace_back(target_.objectPoints()[i]);
            pixels.emplace_back(points[i]);
            const auto third = [](double at, int size) { return std::clamp((int)std::floor(3*at/size), 0, 2); };
            corners_[third(points[i].y, image_.height)][third(points[i].x, image_.width)]++;
        }
    if (pixels.size() < 4)
        return;
    count_++;
    std::vector<cv::Point2f> outline;
    cv::convexHull(pixels, outline);
    const double size = std::sqrt(cv::contourArea(outline)/image_.area());
    nearest_ = std::max(nearest_, size);
    farthest_ = count_ == 1 ? size : std::min(farthest_, size);

    const double focal = GUESSED_FOCAL_LENGTH*image_.width;
    const cv::Matx33d K(focal, 0, 0.5*(image_.width - 1), 0, focal, 0.5*(image_.height - 1), 0, 0, 1);
    cv::Vec3d rvec, tvec;
    if (!cv::solvePnP(object, pixels, K, cv::noArray(), rvec, tvec, false, cv::SOLVEPNP_IPPE))
        return;
    const cv::Matx33d R = cv::refract::rotationMatrix(rvec);
    const double sign = R(2, 2) > 0 ? -1 : 1, least = std::sin(TILT_DEG*CV_PI/180);     // the normal towards the camera
    const double x = sign*R(0, 2), y = sign*R(1, 2);
    for (const auto& side : {std::pair(0, x), std::pair(1, -x), std::pair(2, y), std::pair(3, -y)})
        tilted_[side.first] = tilted_[side.first] || side.second > least;
}

//! The middle comes by itself; corners of the picture first, as the lens bends most there.
std::string NextView::emptyPart() const
{
    static const struct { int row, column; const char* name; } parts[] = {
        {0, 0, "top left corner"}, {0, 2, "top right corner"}, {2, 2, "bottom right corner"}, {2, 0, "bottom left corner"},
        {0, 1, "top"}, {2, 1, "bottom"}, {1, 0, "left"}, {1, 2, "right"}, {1, 1, "middle"}};
    for (const auto& part : parts)
        if (corners_[part.row][part.column] == 0)
            return std::string("hold the board into the ") + part.name + " of the picture";
    return "";
}

std::string NextView::missingTilt() const
{
    const char* const edges[] = {"left", "right", "upper", "lower"};
    for (int i = 0; i < 4; i++)
        if (!tilted_[i])
            return std::string("tilt its ") + edges[i] + " edge towards the camera, by 20 to 35 degrees";
    return "";
}

std::string NextView::missingDistance() const
{
    if (nearest_ < NEAR)
        return "go nearer, until the board fills half of the picture";
    return farthest_ > FAR_OVER_NEAR*nearest_ ? "go farther away, to about twice the distance" : "";
}

std::string NextView::advice() const
{
    for (const std::string& text : {emptyPart(), missingTilt(), missingDistance()})
        if (!text.empty())
            return text;
    return count_ < ENOUGH ? cv::format("%d more, each tilted and turned in another way", ENOUGH - count_) : "";
}

} // namespace tools
