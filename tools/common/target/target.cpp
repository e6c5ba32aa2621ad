// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/target.hpp"
#include "target/april_grid.hpp"
#include "target/charuco.hpp"
#include "target/chessboard.hpp"
#include "target/circle_grid.hpp"
#include "target/dot_target.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/options.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Size;

namespace {

//! As --pattern names them, and in the order in which texts do.
const std::vector<std::pair<std::string, Target::Pattern>> PATTERNS = {
    {"chessboard", Target::CHESSBOARD}, {"circles", Target::CIRCLES},
    {"acircles", Target::ACIRCLES}, {"charuco", Target::CHARUCO}, {"aprilgrid", Target::APRILGRID}};

const double KALIBR_SPACING = 0.3;      // of its boards, if nothing is said

std::vector<Point2d> renumbered(const std::vector<Point2d>& points, const std::vector<int>& order)
{
    std::vector<Point2d> result(order.size());
    for (size_t i = 0; i < order.size(); i++)
        result[i] = points[order[i]];
    return result;
}

double signedArea(const std::vector<Point2d>& points, Size size)
{
    return (points[size.width - 1] - points[0]).cross(points[points.size() - size.width] - points[0]);
}

std::vector<std::string> patternNames()
{
    std::vector<std::string> names;
    for (const auto& pattern : PATTERNS)
        names.push_back(pattern.first);
    return names;
}

//! "chessboard, circles, ... or aprilgrid"
std::string patternChoice()
{
    std::string text = PATTERNS[0].first;
    for (size_t i = 1; i < PATTERNS.size(); i++)
        text += (i + 1 < PATTERNS.size() ? ", " : " or ") + PATTERNS[i].first;
    return text;
}

//! Of a board's points, in sides of a square.
std::vector<cv::Vec2d> placesOf(Target::Pattern pattern, Size size, double tagSpacing)
{
    switch (pattern)
    {
    case Target::CHESSBOARD:
    case Target::CIRCLES:
    case Target::CHARUCO:
        return gridOf(size, false);
    case Target::ACIRCLES:
        return gridOf(size, true);
    case Target::APRILGRID:
        return aprilGridOf(size/2, tagSpacing);
    case Target::DOTS:          // a file says where they are
        break;
    }
    return {};
}

} // namespace

void TargetOptions::addTo(OptionParser& parser, bool required)
{
    parser.add("--pattern", pattern, patternChoice() + " (Kalibr's)").check(isMember(patternNames())).captureDefault();
    parser.add("--size", size, "COLSxROWS: inner corners (chessboard, charuco), dots or tags (aprilgrid)").required(required);
    parser.add("--square", square, "side of a square; distance between dots; acircles: half the distance "
               "between the dots of a row; aprilgrid: side of a tag").required(required).check(moreThanZero());
    parser.add("--marker", marker, "charuco: side of a marker (default: 3/4 of a square)")
        .check(moreThanZero());
    parser.add("--dictionary", dictionary, "charuco: OpenCV's name of the marker dictionary")
        .captureDefault();
    parser.add("--tag-spacing", tagSpacing, "aprilgrid: distance between tags, in sides of a tag, as Kalibr's tagSpacing (default: 0.3)")
        .check(moreThanZero());
    parser.addFlag("--legacy", legacy, "charuco: made by OpenCV before 4.6, with a marker in the first corner (an even number of rows of "
                   "squares)");
}

void TargetOptions::addDotsTo(OptionParser& parser)
{
    Option file = parser.add("--target", dots, "a target of dots on any levels, in place of a board: points.csv with id,x,y,z of each, or "
                             "OpenPTV's list");
    for (const char* other : {"--size", "--square", "--pattern", "--marker", "--dictionary", "--tag-spacing", "--legacy"})
        file.excludes(parser.get(other));
}

Target::Target(const TargetOptions& options)
    : pattern_(options.dots.empty() ? CHESSBOARD : DOTS), size_(options.dots.empty() ? parseSize(options.size, "--size") : Size()),
      square_(options.square), marker_(options.marker), tagSpacing_(options.tagSpacing), dictionary_(0), partial_(options.partial),
      legacy_(options.legacy)
{
    if (pattern_ == DOTS)
    {
        const ListedDots dots = readListedDots(options.dots);
        objectPoints_ = dots.points;
        ids_ = dots.ids;
        size_ = Size((int)dots.points.size(), 1);
        return;
    }
    const auto found = std::find_if(PATTERNS.begin(), PATTERNS.end(), [&](const auto& p) { return p.first == options.pattern; });
    if (found == PATTERNS.end())
        throw Failure("--pattern=" + options.pattern + ": give " + patternChoice());
    pattern_ = found->second;
    if (!(square_ > 0) || !std::isfinite(square_))
        throw Failure("--square: give the length of a square's side, more than 0");
    if (partial_ && pattern_ != CHESSBOARD)
        throw Failure("--partial is for --pattern=chessboard; a ChArUco target may be partly in view as it is");
    const int least = partial_ ? 5 : pattern_ == CHESSBOARD ? 3 : 2;   // what the detectors need
    if (std::min(size_.width, size_.height) < least || (int64_t)size_.width*size_.height > 100000)
        throw Failure("--size=" + options.size + ": a target of at least " + std::to_string(least) + "x"
                      + std::to_string(least) + " points is needed, and no more than 100000 in all");
    if (pattern_ != CHARUCO && legacy_)
        throw Failure("--legacy is for --pattern=charuco: leave it out");
    if (pattern_ != CHARUCO && (marker_ > 0 || options.dictionary != TargetOptions().dictionary))
        throw Failure("--marker and --dictionary are for --pattern=charuco: leave them out");
    if (pattern_ == CHARUCO)
    {
        marker_ = marker_ > 0 ? marker_ : 0.75*square_;
        if (marker_ >= square_)
            throw Failure("--marker: a marker must be smaller than its square (--square)");
        dictionary_ = charucoDictionary(options.dictionary);
        requireMarkers(size_, dictionary_);
    }
    if (pattern_ != APRILGRID && tagSpacing_ > 0)
        throw Failure("--tag-spacing is for --pattern=aprilgrid: leave it out");
    if (pattern_ == APRILGRID)
    {
        tagSpacing_ = tagSpacing_ > 0 ? tagSpacing_ : KALIBR_SPACING;
        if (tagSpacing_ > 1 || size_.area() > APRIL_TAGS)
            throw Failure("--pattern=aprilgrid: a board has up to " + std::to_string(APRIL_TAGS) + " tags, and --tag-spacing is 1 or less");
        size_ = size_*2;
    }
    for (const cv::Vec2d& place : placesOf(pattern_, size_, tagSpacing_))
        objectPoints_.emplace_back(square_*place[0], square_*place[1], 0);
}

//! OpenCV draws no others.
static void requireNewLayout(bool legacy)
{
    if (legacy)
        throw Failure("--legacy: boards are drawn as OpenCV has them since 4.6: leave it out");
}

cv::Mat Target::drawing(int pixelsPerSquare) const
{
    requireNewLayout(legacy_);
    if (pattern_ == APRILGRID)
        return drawAprilGrid(size_/2, tagSpacing_, pixelsPerSquare);
    return pattern_ == CHARUCO ? drawCharuco(size_, square_, marker_, dictionary_, pixelsPerSquare) : Mat();
}

std::string Target::sizeText() const { return tools::sizeText(pattern_ == APRILGRID ? size_/2 : size_); }

std::string Target::patternName() const
{
    return std::find_if(PATTERNS.begin(), PATTERNS.end(), [&](const auto& p) { return p.second == pattern_; })->first;
}

cv::Mat Target::modules() const
{
    requireNewLayout(legacy_);
    return pattern_ == CHARUCO ? charucoModules(size_, dictionary_) : Mat();
}

std::vector<std::pair<int, int>> Target::neighbours() const
{
    std::vector<std::pair<int, int>> pairs;
    for (int row = 0; pattern_ != DOTS && row < size_.height; row++)
        for (int column = 0; column < size_.width; column++)
        {
            const int i = row*size_.width + column;
            if (column + 1 < size_.width)
                pairs.emplace_back(i, i + 1);
            if (row + 1 < size_.height)
                pairs.emplace_back(i, i + size_.width);
        }
    return pairs;
}

std::vector<Point2d> Target::detect(const Mat& grey, Size* other) const
{
    std::vector<Point2d> points;
    switch (pattern_)
    {
    case CHESSBOARD:
        if (partial_)
            return detectPartialChessboard(grey, size_);
        points = detectChessboard(grey, size_, other);
        break;
    case CIRCLES:
    case ACIRCLES:
        points = detectCircleGrid(grey, size_, pattern_ == ACIRCLES);
        break;
    case CHARUCO:
        return detectCharuco(grey, size_, square_, marker_, dictionary_, legacy_);
    case APRILGRID:
        return detectAprilGrid(grey, size_/2, tagSpacing_);
    case DOTS:
        return detectListedDots(grey, objectPoints_);
    }
    return points.empty() ? points : canonical(points, grey);
}

bool Target::isLikelySeen(const Mat& grey) const
{
    if (partial_)
        return !lookForChessboard(grey).empty();
    return pattern_ == CHESSBOARD ? isChessboardLikely(grey, size_) : !detect(grey).empty();
}

std::vector<std::vector<int>> Target::symmetries() const
{
    const int columns = size_.width, rows = size_.height;
    std::vector<std::vector<int>> orders(1);
    for (int i = 0; i < count(); i++)
        orders[0].push_back(i);
    bool halfTurn = false;
    switch (pattern_)
    {
    case CHESSBOARD:
        halfTurn = (columns + rows) % 2 == 0;
        break;
    case CIRCLES:
        halfTurn = true;
        break;
    case ACIRCLES:
        halfTurn = rows % 2 == 0;
        break;
    case CHARUCO:
    case APRILGRID:
    case DOTS:                  // each point is told from all others
        break;
    }
    if (halfTurn)
        orders.emplace_back(orders[0].rbegin(), orders[0].rend());
    if (pattern_ == CIRCLES && columns == rows)
        for (const int direction : {1, -1})
        {
            std::vector<int> turned;
            for (int row = 0; row < rows; row++)
                for (int column = 0; column < columns; column++)
                    turned.push_back(direction > 0 ? (rows - 1 - column)*columns + row
                                                   : column*columns + (columns - 1 - row));
            orders.push_back(turned);
        }
    return orders;
}

//! A board's points with those that were not seen about where they must be.
static std::vector<Point2d> completed(const std::vector<Point2d>& points, const std::vector<cv::Point3d>& objectPoints)
{
    if (std::all_of(points.begin(), points.end(), seen))
        return points;
    std::vector<Point2d> pixels, known, board, all;
    for (size_t i = 0; i < points.size(); i++)
    {
        board.emplace_back(objectPoints[i].x, objectPoints[i].y);
        if (seen(points[i]))
        {
            pixels.push_back(points[i]);
            known.push_back(board[i]);
        }
    }
    cv::perspectiveTransform(board, all, cv::findHomography(known, pixels));
    for (size_t i = 0; i < points.size(); i++)
        if (seen(points[i]))
            all[i] = points[i];
    return all;
}

std::vector<Point2d> Target::canonical(const std::vector<Point2d>& points, const Mat& grey) const
{
    const std::vector<Point2d> whole = completed(points, objectPoints_);
    std::vector<int> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    if (pattern_ != ACIRCLES && signedArea(whole, size_) < 0)      // x right, y down, seen from the front
        for (int row = 0; row < size_.height; row++)
            std::reverse(order.begin() + row*size_.width, order.begin() + (row + 1)*size_.width);
    if (pattern_ == CHESSBOARD && contrastOfFirstSquare(renumbered(whole, order), size_, grey) > 0)
    {
        if ((size_.width + size_.height) % 2)
            std::reverse(order.begin(), order.end());
        else if (size_.width == size_.height)       // a quarter turn swaps dark and light
        {
            std::vector<int> turned;
            for (int row = 0; row < size_.height; row++)
                for (int column = 0; column < size_.width; column++)
                    turned.push_back(order[(size_.height - 1 - column)*size_.width + row]);
            order = turned;
        }
    }
    const auto fromTopLeft = [&](int i) { return whole[i].x + whole[i].y; };
    const std::vector<std::vector<int>> turns = symmetries();
    const std::vector<int>* best = &turns[0];
    for (const std::vector<int>& turn : turns)
        if (fromTopLeft(order[turn[0]]) < fromTopLeft(order[(*best)[0]]))
            best = &turn;
    return renumbered(renumbered(points, order), *best);
}

std::vector<Point2d> Target::alignWith(const std::vector<Point2d>& reference, const std::vector<Point2d>& points) const
{
    std::vector<Point2d> best = points;
    double bestAgreement = -std::numeric_limits<double>::max();
    for (const std::vector<int>& order : symmetries())
    {
        const std::vector<Point2d> candidate = renumbered(points, order);
        double agreement = 0;       // of the directions along the rows and along the columns
        for (const auto& pair : neighbours())
        {
            const Point2d a = reference[pair.second] - reference[pair.first];
            const Point2d b = candidate[pair.second] - candidate[pair.first];
            if (seen(a) && seen(b))
                agreement += a.dot(b);
        }
        if (agreement > bestAgreement)
        {
            bestAgreement = agreement;
            best = candidate;
        }
    }
    return best;
}

} // namespace tools
