// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/chessboard.hpp"
#include "target/refine_points.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <limits>

using namespace cv;

namespace tools {

namespace {

const int LEAST = 3;                // rows and columns of a piece that is worth keeping
const int SIDE_OF_COPY = 1000;      // pixels: enough to see what is there
const double ABRUPT = 1.6;          // ratio of two steps in a row; a board near and steep to the camera reaches 1.3

//! x right, y down, seen from the front: the same handedness as the object points.
bool isMirrored(const Mat_<Point2f>& grid)
{
    const Point2f right = grid(0, grid.cols - 1) - grid(0, 0), down = grid(grid.rows - 1, 0) - grid(0, 0);
    return right.cross(down) < 0;
}

//! The found grid turned so that it lies in `size`, without its outermost corners; empty if too little is left.
Mat_<Point2f> inner(Mat_<Point2f> grid, Size size)
{
    if ((grid.cols > size.width || grid.rows > size.height) && grid.rows <= size.width && grid.cols <= size.height)
        grid = grid.t();
    grid = grid(Rect(0, 0, std::min(grid.cols, size.width), std::min(grid.rows, size.height)));
    if (std::min(grid.cols, grid.rows) < LEAST + 2)
        return Mat_<Point2f>();
    grid = grid(Rect(1, 1, grid.cols - 2, grid.rows - 2)).clone();
    if (isMirrored(grid))
        flip(grid.clone(), grid, 0);
    return grid;
}

Mat smallCopy(const Mat& grey)
{
    const double scale = std::min(1., (double)SIDE_OF_COPY/std::max(grey.cols, grey.rows));
    Mat copy;
    resize(grey, copy, Size(), scale, scale, INTER_AREA);
    return copy;
}

bool isEvenStep(const Point2d& a, const Point2d& b, const Point2d& c)
{
    const double first = norm(b - a), second = norm(c - b);
    return !(std::max(first, second) > ABRUPT*std::min(first, second));   // true with a NaN
}

/** False if the steps along some row or column change more abruptly than perspective can make them: the detector has
skipped corners, or taken cut squares for whole ones. NaN points are passed over. */
bool isEvenGrid(const std::vector<Point2d>& points, Size size)
{
    const auto at = [&](int row, int column) { return points[row*size.width + column]; };
    for (int row = 0; row < size.height; row++)
        for (int column = 0; column < size.width; column++)
            if ((column > 1 && !isEvenStep(at(row, column - 2), at(row, column - 1), at(row, column))) ||
                (row > 1 && !isEvenStep(at(row - 2, column), at(row - 1, column), at(row, column))))
                return false;
    return true;
}

std::vector<Point2d> toDouble(const std::vector<Point2f>& points)
{
    return std::vector<Point2d>(points.begin(), points.end());
}

//! Of a few pixels about one.
double brightnessAt(const Mat& grey, const Point2f& pixel)
{
    Mat patch;
    getRectSubPix(grey, Size(3, 3), pixel, patch);
    return mean(patch)[0];
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

/* Not by adaptive thresholds (CALIB_CB_ADAPTIVE_THRESH): where it finds a board it finds it without them, and with them takes every
speck of noise for a square, for minutes. */
bool detectByOldChessboard(const Mat& grey, Size size, std::vector<Point2f>& corners)
{
    return findChessboardCorners(grey, size, corners, CALIB_CB_NORMALIZE_IMAGE | CALIB_CB_FAST_CHECK)
        && isChessboard(toDouble(corners), size, grey);
}

} // namespace

std::vector<Point2d> detectPartialChessboard(const Mat& grey, Size size)
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    // The detector starts from a grid of a given size and lets it grow; a large start is the more reliable.
    for (int less = 2; ; less++)
    {
        const Size start(size.width - less, size.height - less);
        if (std::min(start.width, start.height) < LEAST)
            return {};
        std::vector<Point2f> corners;
        Mat meta;
        if (!findChessboardCornersSB(grey, start, corners,
                                     CALIB_CB_EXHAUSTIVE | CALIB_CB_ACCURACY | CALIB_CB_LARGER, meta))
            continue;
        const Mat_<Point2f> piece = inner(Mat_<Point2f>(meta.rows, meta.cols, corners.data()), size);
        std::vector<Point2d> points(size.area(), Point2d(nan, nan));
        for (int row = 0; row < piece.rows; row++)
            for (int column = 0; column < piece.cols; column++)
                points[row*size.width + column] = piece(row, column);
        if (!piece.empty() && isEvenGrid(points, size))
            return points;
    }
}

bool isChessboardLikely(const Mat& grey, Size size)
{
    std::vector<Point2f> corners;
    return findChessboardCornersSB(smallCopy(grey), size, corners);
}

Size lookForChessboard(const Mat& grey)
{
    const int leastCorners = 12;
    const Mat copy = smallCopy(grey);
    Size largest;
    for (int start = LEAST + 2; start >= LEAST; start--)        // none of them finds every board
    {
        Mat meta;
        std::vector<Point2f> corners;
        if (findChessboardCornersSB(copy, Size(start, start), corners, CALIB_CB_EXHAUSTIVE | CALIB_CB_LARGER, meta)
            && meta.size().area() >= std::max(leastCorners, largest.area() + 1) && isEvenGrid(toDouble(corners), meta.size()))
            largest = longerFirst(meta.size());
    }
    return largest;
}

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
finds some boards among clutter, and parts of larger ones. */
std::vector<Point2d> detectChessboard(const Mat& grey, Size size, Size* other)
{
    std::vector<Point2f> corners;
    if (!findChessboardCornersSB(grey, size, corners, CALIB_CB_EXHAUSTIVE)
        || !isChessboard(toDouble(corners), size, grey))
    {
        const Size whole = longerFirst(size), seen = other ? lookForChessboard(grey) : Size();
        if (other)
            *other = seen != whole ? seen : Size();
        if (seen.width > whole.width || seen.height > whole.height || !detectByOldChessboard(grey, size, corners))
            return {};
    }
    if (other)
        *other = Size();
    refineCorners(grey, corners, 0.35);
    return toDouble(corners);
}

} // namespace tools
