#include "target/target.hpp"
#include "target/charuco.hpp"
#include "target/limited_search.hpp"
#include "target/partial_chessboard.hpp"
#include "target/refine_corners.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Point2f;
using cv::Size;

namespace {

const std::map<std::string, Target::Pattern> PATTERNS = {
    {"chessboard", Target::CHESSBOARD}, {"circles", Target::CIRCLES},
    {"acircles", Target::ACIRCLES}, {"charuco", Target::CHARUCO}};

std::vector<Point2d> toDouble(const std::vector<Point2f>& points)
{
    return std::vector<Point2d>(points.begin(), points.end());
}

//! Brightness in the middle of each square between the corners.
cv::Mat_<double> squaresOf(const std::vector<Point2d>& points, Size size, const Mat& grey)
{
    cv::Mat_<double> squares(size.height - 1, size.width - 1);
    for (int row = 0; row < squares.rows; ++row)
        for (int column = 0; column < squares.cols; ++column)
        {
            const int i = row * size.width + column;
            const Point2d centre = 0.25 * (points[i] + points[i + 1] + points[i + size.width] + points[i + size.width + 1]);
            Mat patch;
            cv::getRectSubPix(grey, Size(3, 3), Point2f(centre), patch);
            squares(row, column) = cv::mean(patch)[0];
        }
    return squares;
}

//! Light minus dark, summed over the squares between the corners, as seen from the first one: negative if it is dark.
double contrastOfFirstSquare(const std::vector<Point2d>& points, Size size, const Mat& grey)
{
    const cv::Mat_<double> squares = squaresOf(points, size, grey);
    double contrast = 0;
    for (int row = 0; row < squares.rows; ++row)
        for (int column = 0; column < squares.cols; ++column)
            contrast += ((row + column) % 2 ? -1 : 1) * squares(row, column);
    return contrast;
}

/* Neighbouring squares are dark and light in turn. Where a detector took every other corner, they are not: it does so to find
the corners of a board of another size. */
bool isAlternating(const std::vector<Point2d>& points, Size size, const Mat& grey)
{
    const cv::Mat_<double> squares = squaresOf(points, size, grey);
    int inTurn[2] = {0, 0}, all = 0;            // by which comes first
    for (int row = 0; row < squares.rows; ++row)
        for (int column = 0; column < squares.cols; ++column)
            for (const cv::Point step : {cv::Point(1, 0), cv::Point(0, 1)})
                if (column + step.x < squares.cols && row + step.y < squares.rows)
                {
                    const bool lighter = squares(row, column) > squares(row + step.y, column + step.x);
                    ++inTurn[lighter == ((row + column) % 2 == 0)];
                    ++all;
                }
    return std::max(inTurn[0], inTurn[1]) >= 0.8 * all;
}

//! A detector that has skipped corners, or taken a board's edge for some, has not found the target.
bool isChessboard(const std::vector<Point2d>& points, Size size, const Mat& grey)
{
    return isEvenGrid(points, size) && isAlternating(points, size, grey);
}

// Processor time that is given to detectors which may take minutes for nothing.
const int SECONDS_OF_OLD_CHESSBOARD = 5, SECONDS_OF_CIRCLES = 20;

//! The longer side first.
Size sorted(Size size)
{
    return Size(std::max(size.width, size.height), std::min(size.width, size.height));
}

std::vector<Point2f> detectByOldChessboard(const Mat& grey, Size size)
{
    return searchLimited(SECONDS_OF_OLD_CHESSBOARD, size.area(), [&] {
        std::vector<Point2f> corners;
        const bool found = cv::findChessboardCorners(grey, size, corners, cv::CALIB_CB_ADAPTIVE_THRESH
                                                     | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK);
        return found ? corners : std::vector<Point2f>();
    });
}

/* The sector-based detector is the more tolerant of blur and of boards that are partly cut off; the older one still
finds some boards among clutter. But it takes half a minute, or several, where there is a board of another size, or curved by
a wide-angle lens: so a glance at a small copy of the image goes before it, and its time is limited. */
std::vector<Point2d> detectChessboard(const Mat& grey, Size size, Size& other)
{
    std::vector<Point2f> corners;
    if (!cv::findChessboardCornersSB(grey, size, corners, cv::CALIB_CB_EXHAUSTIVE)
        || !isChessboard(toDouble(corners), size, grey))
    {
        const Size glance = lookForChessboard(grey);
        if (sorted(glance) != sorted(size))
            other = sorted(glance);
        if (other.width > sorted(size).width || other.height > sorted(size).height)
            return {};
        corners = detectByOldChessboard(grey, size);
        if (corners.empty() || !isChessboard(toDouble(corners), size, grey))
            return {};
    }
    other = Size();
    refineCorners(grey, corners, 0.35);
    return toDouble(corners);
}

//! Dark dots on light ground, or the reverse; the largest dot that can fit decides the blob detector's limits.
std::vector<Point2f> detectCircles(const Mat& grey, Size size, bool asymmetric)
{
    cv::SimpleBlobDetector::Params limits;
    limits.maxArea = std::max(limits.maxArea, (float)(grey.total() / size.area()));
    const int flags = asymmetric ? cv::CALIB_CB_ASYMMETRIC_GRID : cv::CALIB_CB_SYMMETRIC_GRID;
    for (const uchar colour : {0, 255})
    {
        limits.blobColor = colour;
        const auto detector = cv::SimpleBlobDetector::create(limits);
        for (const int extra : {0, (int)cv::CALIB_CB_CLUSTERING})
        {
            std::vector<Point2f> centres;
            if (cv::findCirclesGrid(grey, size, centres, flags | extra, detector))
                return centres;
        }
    }
    return {};
}

std::vector<Point2d> renumbered(const std::vector<Point2d>& points, const std::vector<int>& order)
{
    std::vector<Point2d> result(order.size());
    for (size_t i = 0; i < order.size(); ++i)
        result[i] = points[order[i]];
    return result;
}

double signedArea(const std::vector<Point2d>& points, Size size)
{
    return (points[size.width - 1] - points[0]).cross(points[points.size() - size.width] - points[0]);
}

} // namespace

void TargetOptions::addTo(CLI::App& app, bool required)
{
    app.add_option("--pattern", pattern, "chessboard, circles, acircles or charuco")
        ->check(CLI::IsMember({"chessboard", "circles", "acircles", "charuco"}))->capture_default_str();
    app.add_option("--size", size, "COLSxROWS: inner corners (chessboard, charuco) or dots")->required(required);
    app.add_option("--square", square, "side of a square; distance between dots; acircles: half the distance "
                   "between the dots of a row")->required(required)->check(moreThanZero());
    app.add_option("--marker", marker, "charuco: side of a marker (default: 3/4 of a square)")
        ->check(moreThanZero());
    app.add_option("--dictionary", dictionary, "charuco: OpenCV's name of the marker dictionary")
        ->capture_default_str();
}

Target::Target(const TargetOptions& options)
    : pattern_(CHESSBOARD), size_(parseSize(options.size, "--size")), square_(options.square),
      marker_(options.marker), dictionary_(0), partial_(options.partial)
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
    if (std::min(size_.width, size_.height) < least || (int64_t)size_.width * size_.height > 100000)
        throw Failure("--size=" + options.size + ": a target of at least " + std::to_string(least) + "x"
                      + std::to_string(least) + " points is needed, and no more than 100000 in all");
    if (pattern_ == CHARUCO)
    {
        marker_ = marker_ > 0 ? marker_ : 0.75 * square_;
        if (marker_ >= square_)
            throw Failure("--marker: a marker must be smaller than its square (--square)");
        dictionary_ = charucoDictionary(options.dictionary);
        requireMarkers(size_, dictionary_);
    }
    for (int row = 0; row < size_.height; ++row)
        for (int column = 0; column < size_.width; ++column)
            objectPoints_.emplace_back(square_ * (pattern_ == ACIRCLES ? 2 * column + row % 2 : column), square_ * row, 0);
}

cv::Mat Target::drawing(int pixelsPerSquare) const
{
    return pattern_ == CHARUCO ? drawCharuco(size_, square_, marker_, dictionary_, pixelsPerSquare) : Mat();
}

std::vector<std::pair<int, int>> Target::neighbours() const
{
    std::vector<std::pair<int, int>> pairs;
    for (int row = 0; row < size_.height; ++row)
        for (int column = 0; column < size_.width; ++column)
        {
            const int i = row * size_.width + column;
            if (column + 1 < size_.width)
                pairs.emplace_back(i, i + 1);
            if (row + 1 < size_.height)
                pairs.emplace_back(i, i + size_.width);
        }
    return pairs;
}

std::vector<Point2d> Target::detect(const Mat& grey, Size* other) const
{
    Size seenSize;
    if (pattern_ == CHARUCO)
        return detectCharuco(grey, size_, square_, marker_, dictionary_);
    if (partial_)
        return detectPartialChessboard(grey, size_);
    const std::vector<Point2d> points = pattern_ == CHESSBOARD ? detectChessboard(grey, size_, seenSize)
        : toDouble(searchLimited(SECONDS_OF_CIRCLES, count(), [&] { return detectCircles(grey, size_, pattern_ == ACIRCLES); }));
    if (other)
        *other = seenSize;
    return points.empty() ? points : canonical(points, grey);
}

std::vector<std::vector<int>> Target::symmetries() const
{
    const int columns = size_.width, rows = size_.height;
    std::vector<std::vector<int>> orders(1);
    for (int i = 0; i < count(); ++i)
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
            for (int row = 0; row < rows; ++row)
                for (int column = 0; column < columns; ++column)
                    turned.push_back(direction > 0 ? (rows - 1 - column) * columns + row
                                                   : column * columns + (columns - 1 - row));
            orders.push_back(turned);
        }
    return orders;
}

std::vector<Point2d> Target::canonical(const std::vector<Point2d>& points, const Mat& grey) const
{
    std::vector<Point2d> result = points;
    if (pattern_ != ACIRCLES && signedArea(result, size_) < 0)      // x right, y down, seen from the front
        for (int row = 0; row < size_.height; ++row)
            std::reverse(result.begin() + row * size_.width, result.begin() + (row + 1) * size_.width);
    if (pattern_ == CHESSBOARD && contrastOfFirstSquare(result, size_, grey) > 0)
    {
        if ((size_.width + size_.height) % 2)
            std::reverse(result.begin(), result.end());
        else if (size_.width == size_.height)       // a quarter turn swaps dark and light
        {
            std::vector<Point2d> turned;
            for (int row = 0; row < size_.height; ++row)
                for (int column = 0; column < size_.width; ++column)
                    turned.push_back(result[(size_.height - 1 - column) * size_.width + row]);
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
