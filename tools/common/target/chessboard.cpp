// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/chessboard.hpp"
#include "target/limited_search.hpp"
#include "target/partial_chessboard.hpp"
#include "target/refine_corners.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>

using namespace cv;

namespace tools {

namespace {

std::vector<Point2d> toDouble(const std::vector<Point2f>& points)
{
    return std::vector<Point2d>(points.begin(), points.end());
}

//! Brightness in the middle of each square between the corners.
Mat_<double> squaresOf(const std::vector<Point2d>& points, Size size, const Mat& grey)
{
    Mat_<double> squares(size.height - 1, size.width - 1);
    for (int row = 0; row < squares.rows; row++)
        for (int column = 0; column < squares.cols; column++)
        {
            const int i = row*size.width + column;
            const Point2d centre = 0.25*(points[i] + points[i + 1] + points[i + size.width] + points[i + size.width + 1]);
            squares(row, column) = brightnessAt(grey, Point2f(centre));
        }
    return squares;
}

/* Neighbouring squares are dark and light in turn. Where a detector took every other corner, they are not: it does so to find
the corners of a board of another size. */
bool isAlternating(const std::vector<Point2d>& points, Size size, const Mat& grey)
{
    const Mat_<double> squares = squaresOf(points, size, grey);
    int inTurn[2] = {0, 0}, all = 0;            // by which comes first
    for (int row = 0; row < squares.rows; row++)
        for (int column = 0; column < squares.cols; column++)
            for (const Point step : {Point(1, 0), Point(0, 1)})
                if (column + step.x < squares.cols && row + step.y < squares.rows)
                {
                    const bool lighter = squares(row, column) > squares(row + step.y, column + step.x);
                    ++inTurn[lighter == ((row + column) % 2 == 0)];
                    all++;
                }
    return std::max(inTurn[0], inTurn[1]) >= 0.8*all;
}

//! A detector that has skipped corners, or taken a board's edge for some, has not found the target.
bool isChessboard(const std::vector<Point2d>& points, Size size, const Mat& grey)
{
    return isEvenGrid(points, size) && isAlternating(points, size, grey);
}

std::vector<Point2f> detectByOldChessboard(const Mat& grey, Size size, int seconds)
{
    return searchLimited(seconds, size.area(), [&] {
        std::vector<Point2f> corners;
        const bool found = findChessboardCorners(grey, size, corners, CALIB_CB_ADAPTIVE_THRESH
                                                     | CALIB_CB_NORMALIZE_IMAGE | CALIB_CB_FAST_CHECK);
        return found ? corners : std::vector<Point2f>();
    });
}

} // namespace

double contrastOfFirstSquare(const std::vector<Point2d>& points, Size size, const Mat& grey)
{
    const Mat_<double> squares = squaresOf(points, size, grey);
    double contrast = 0;
    for (int row = 0; row < squares.rows; row++)
        for (int column = 0; column < squares.cols; column++)
            contrast += ((row + column) % 2 ? -1 : 1)*squares(row, column);
    return contrast;
}

/* The sector-based detector is the more tolerant of blur and of boards that are partly cut off; the older one still
finds some boards among clutter. But it takes half a minute, or several, where there is a board of another size, or a part of one, or one
curved by a wide-angle lens: so a glance at a small copy of the image goes before it, and its time is limited. */
std::vector<Point2d> detectChessboard(const Mat& grey, Size size, Size* other, int seconds)
{
    std::vector<Point2f> corners;
    if (!findChessboardCornersSB(grey, size, corners, CALIB_CB_EXHAUSTIVE)
        || !isChessboard(toDouble(corners), size, grey))
    {
        if (!other && !checkChessboard(grey, size))         // nor would the older one find any
            return {};
        const auto isCutOff = [&](const SeenChessboard& seen) {
            return !mayBeInView(seen, size, grey)
                && isAlternating(std::vector<Point2d>(seen.corners.begin(), seen.corners.end()), seen.size, grey); };
        const SeenChessboard glance = other ? lookForChessboard(grey) : lookForChessboard(grey, isCutOff);
        const Size seenSize = longerFirst(glance.size) != longerFirst(size) ? longerFirst(glance.size) : Size();
        if (other)
            *other = seenSize;
        if (seenSize.width > longerFirst(size).width || seenSize.height > longerFirst(size).height || !mayBeInView(glance, size, grey))
            return {};
        corners = detectByOldChessboard(grey, size, seconds);
        if (corners.empty() || !isChessboard(toDouble(corners), size, grey))
            return {};
    }
    if (other)
        *other = Size();
    refineCorners(grey, corners, 0.35);
    return toDouble(corners);
}

} // namespace tools
