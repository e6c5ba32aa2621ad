// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/target.hpp"
#include "target/charuco.hpp"
#include "target/chessboard.hpp"
#include "target/circle_grid.hpp"
#include "target/partial_chessboard.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/options.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Size;

namespace {

const std::map<std::string, Target::Pattern> PATTERNS = {
    {"chessboard", Target::CHESSBOARD}, {"circles", Target::CIRCLES},
    {"acircles", Target::ACIRCLES}, {"charuco", Target::CHARUCO}};

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

} // namespace

void TargetOptions::addTo(OptionParser& parser, bool required)
{
    parser.add("--pattern", pattern, "chessboard, circles, acircles or charuco")
        .check(isMember({"chessboard", "circles", "acircles", "charuco"})).captureDefault();
    parser.add("--size", size, "COLSxROWS: inner corners (chessboard, charuco) or dots").required(required);
    parser.add("--square", square, "side of a square; distance between dots; acircles: half the distance "
               "between the dots of a row").required(required).check(moreThanZero());
    parser.add("--marker", marker, "charuco: side of a marker (default: 3/4 of a square)")
        .check(moreThanZero());
    parser.add("--dictionary", dictionary, "charuco: OpenCV's name of the marker dictionary")
        .captureDefault();
    parser.addFlag("--legacy", legacy, "charuco: made by OpenCV before 4.6, with a marker in the first corner (an even number of rows of "
                   "squares)");
}

Target::Target(const TargetOptions& options)
    : pattern_(CHESSBOARD), size_(parseSize(options.size, "--size")), square_(options.square),
      marker_(options.marker), dictionary_(0), partial_(options.partial), legacy_(options.legacy)
{
    const auto found = PATTERNS.find(options.pattern);
    if (found == PATTERNS.end())
        throw Failure("--pattern=" + options.pattern + ": give chessboard, circles, acircles or charuco");
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
    for (const cv::Vec2d& place : gridOf(size_, pattern_ == ACIRCLES))
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
    return pattern_ == CHARUCO ? drawCharuco(size_, square_, marker_, dictionary_, pixelsPerSquare) : Mat();
}

cv::Mat Target::modules() const
{
    requireNewLayout(legacy_);
    return pattern_ == CHARUCO ? charucoModules(size_, dictionary_) : Mat();
}

std::vector<std::pair<int, int>> Target::neighbours() const
{
    std::vector<std::pair<int, int>> pairs;
    for (int row = 0; row < size_.height; row++)
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

std::vector<Point2d> Target::detect(const Mat& grey, Size* other, Effort effort) const
{
    Size seenSize;
    const int hurried = 2 + (int)(grey.total()/1000000);        // so that a large image is not given up for its size
    const int secondsOfChessboard = effort == HURRIED ? std::min(hurried, 5) : 5;
    const int secondsOfDots = effort == HURRIED ? std::min(hurried, 20) : 20;
    if (pattern_ == CHARUCO)
        return detectCharuco(grey, size_, square_, marker_, dictionary_, legacy_);
    if (partial_)
        return detectPartialChessboard(grey, size_);
    const std::vector<Point2d> points = pattern_ == CHESSBOARD ? detectChessboard(grey, size_, seenSize, secondsOfChessboard)
        : detectCircleGrid(grey, size_, pattern_ == ACIRCLES, secondsOfDots);
    if (other)
        *other = seenSize;
    return points.empty() ? points : canonical(points, grey);
}

bool Target::glimpse(const Mat& grey) const
{
    if (partial_)
        return !lookForChessboard(grey).empty();
    return pattern_ == CHESSBOARD ? glimpseChessboard(grey, size_) : !detect(grey, nullptr, HURRIED).empty();
}

std::vector<std::vector<int>> Target::symmetries() const
{
    const int columns = size_.width, rows = size_.height;
    std::vector<std::vector<int>> orders(1);
    for (int i = 0; i < count(); i++)
        orders[0].push_back(i);
    if (pattern_ == CHARUCO)
        return orders;
    const bool halfTurn = pattern_ == CIRCLES || (pattern_ == CHESSBOARD && (columns + rows) % 2 == 0)
                          || (pattern_ == ACIRCLES && rows % 2 == 0);
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

std::vector<Point2d> Target::canonical(const std::vector<Point2d>& points, const Mat& grey) const
{
    std::vector<Point2d> result = points;
    if (pattern_ != ACIRCLES && signedArea(result, size_) < 0)      // x right, y down, seen from the front
        for (int row = 0; row < size_.height; row++)
            std::reverse(result.begin() + row*size_.width, result.begin() + (row + 1)*size_.width);
    if (pattern_ == CHESSBOARD && contrastOfFirstSquare(result, size_, grey) > 0)
    {
        if ((size_.width + size_.height) % 2)
            std::reverse(result.begin(), result.end());
        else if (size_.width == size_.height)       // a quarter turn swaps dark and light
        {
            std::vector<Point2d> turned;
            for (int row = 0; row < size_.height; row++)
                for (int column = 0; column < size_.width; column++)
                    turned.push_back(result[(size_.height - 1 - column)*size_.width + row]);
            result = turned;
        }
    }
    std::vector<Point2d> best = result;
    for (const std::vector<int>& order : symmetries())
        if (result[order[0]].x + result[order[0]].y < best[0].x + best[0].y)
            best = renumbered(result, order);
    return best;
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
