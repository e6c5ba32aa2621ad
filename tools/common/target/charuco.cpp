// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/charuco.hpp"
#include "console/failure.hpp"
#include "target/refine_points.hpp"

#include <opencv2/core/version.hpp>
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#define REFRACT_OPENCV_AT_LEAST_4_7 (CV_VERSION_MAJOR*100 + CV_VERSION_MINOR >= 407)
#if REFRACT_OPENCV_AT_LEAST_4_7
#include <opencv2/objdetect/charuco_detector.hpp>
#else
#include <opencv2/aruco/charuco.hpp>
#endif

namespace tools {

int charucoDictionary(const std::string& name)
{
    static const std::map<std::string, int> numbers = {
        {"DICT_4X4_50", cv::aruco::DICT_4X4_50}, {"DICT_4X4_100", cv::aruco::DICT_4X4_100},
        {"DICT_4X4_250", cv::aruco::DICT_4X4_250}, {"DICT_4X4_1000", cv::aruco::DICT_4X4_1000},
        {"DICT_5X5_50", cv::aruco::DICT_5X5_50}, {"DICT_5X5_100", cv::aruco::DICT_5X5_100},
        {"DICT_5X5_250", cv::aruco::DICT_5X5_250}, {"DICT_5X5_1000", cv::aruco::DICT_5X5_1000},
        {"DICT_6X6_50", cv::aruco::DICT_6X6_50}, {"DICT_6X6_100", cv::aruco::DICT_6X6_100},
        {"DICT_6X6_250", cv::aruco::DICT_6X6_250}, {"DICT_6X6_1000", cv::aruco::DICT_6X6_1000},
        {"DICT_7X7_50", cv::aruco::DICT_7X7_50}, {"DICT_7X7_100", cv::aruco::DICT_7X7_100},
        {"DICT_7X7_250", cv::aruco::DICT_7X7_250}, {"DICT_7X7_1000", cv::aruco::DICT_7X7_1000},
        {"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL}};
    const auto found = numbers.find(name);
    if (found == numbers.end())
        throw Failure("--dictionary=" + name + ": not one of OpenCV's, such as DICT_4X4_250 or DICT_ARUCO_ORIGINAL");
    return found->second;
}

namespace {

cv::Size squaresOf(cv::Size innerCorners)
{
    return cv::Size(innerCorners.width + 1, innerCorners.height + 1);
}

//! The squares with markers, in the order of their numbers. Only with an even number of rows are the layouts different.
std::vector<cv::Point> markerSquares(cv::Size squares, bool legacy)
{
    const int first = legacy && squares.height % 2 == 0 ? 0 : 1;        // column of the first marker of the first row
    std::vector<cv::Point> places;
    for (int y = 0; y < squares.height; y++)
        for (int x = (first + y) % 2; x < squares.width; x += 2)
            places.push_back({x, y});
    return places;
}

typedef std::vector<std::vector<cv::Point2f>> MarkerCorners;

//! How far the markers are, at the least, from where a flat board of this layout has them, in squares; 0 if there are too few to tell.
double misfit(const MarkerCorners& corners, const std::vector<int>& ids, cv::Size squares, bool legacy)
{
    const std::vector<cv::Point> places = markerSquares(squares, legacy);
    const int LEAST = 6, ROWS = 3;      // markers of one row are all one square further in the other layout
    std::vector<cv::Point2f> pixels, board;
    std::set<int> rows;
    for (size_t i = 0; i < ids.size(); i++)
        if (ids[i] >= 0 && ids[i] < (int)places.size())
        {
            const std::vector<cv::Point2f>& c = corners[i];
            pixels.push_back((c[0] + c[1] + c[2] + c[3])*0.25f);
            board.push_back(places[ids[i]]);
            rows.insert(places[ids[i]].y);
        }
    const cv::Mat H = (int)board.size() < LEAST || (int)rows.size() < ROWS ? cv::Mat() : cv::findHomography(pixels, board);
    if (H.empty())
        return 0.;
    std::vector<cv::Point2f> seen;
    cv::perspectiveTransform(pixels, seen, H);
    return cv::norm(seen, board, cv::NORM_L2)/std::sqrt((double)board.size());
}

const double WRONG = 0.15, RIGHT = 0.05;        // misfits: what a lens bends is far less than a square
const int MOST = 60;                            // columns or rows of squares

//! How many columns of squares the markers have, by where they are; 0: that is not told.
int columnsOf(const MarkerCorners& corners, const std::vector<int>& ids)
{
    for (int columns = 2; columns <= MOST; columns++)
        for (bool legacy : {false, true})
        {
            const double off = misfit(corners, ids, cv::Size(columns, MOST), legacy);
            if (off > 0. && off < RIGHT)
                return columns;
        }
    return 0;
}

//! How many rows of squares are seen to have markers, if these are in so many columns.
int rowsOf(const std::vector<int>& ids, int columns, bool legacy = false)
{
    const int last = *std::max_element(ids.begin(), ids.end());
    return markerSquares(cv::Size(columns, 2*(last + 1)), legacy)[last].y + 1;
}

//! Those of fewer rows have the same numbers in the same places.
void requireNoMoreRows(const MarkerCorners& corners, const std::vector<int>& ids, cv::Size squares)
{
    if (ids.empty() || rowsOf(ids, squares.width) > MOST)
        return;
    for (bool legacy : {false, true})
    {
        const double off = misfit(corners, ids, cv::Size(squares.width, MOST), legacy);
        const int rows = rowsOf(ids, squares.width, legacy);
        if (off > 0. && off < RIGHT && rows > squares.height)
            throw Failure(cv::format("this ChArUco board has %d rows of squares or more, and %d with --size=%dx%d: give --size=%dx%d, "
                                     "or how many rows of inner corners there are", rows, squares.height, squares.width - 1,
                                     squares.height - 1, squares.width - 1, rows - 1));
    }
}

void requireLayout(const MarkerCorners& corners, const std::vector<int>& ids, cv::Size squares, bool legacy)
{
    requireNoMoreRows(corners, ids, squares);
    if (!(misfit(corners, ids, squares, legacy) > WRONG))
        return;
    if (squares.height % 2 == 0 && misfit(corners, ids, squares, !legacy) < RIGHT)
        throw Failure(legacy ? "the markers of this ChArUco board are where OpenCV puts them since 4.6: leave --legacy out"
                             : "the markers of this ChArUco board are where OpenCV put them before 4.6 (a marker in the first corner, of a "
                               "board with an even number of rows): say --legacy");
    const int columns = columnsOf(corners, ids);
    if (columns > 0 && columns == squares.width - 1 && rowsOf(ids, columns) == squares.height - 1)
        throw Failure(cv::format("this ChArUco board has %dx%d squares, as many as --size=%dx%d says of inner corners: give --size=%dx%d",
                                 columns, squares.height - 1, columns, squares.height - 1, columns - 1, squares.height - 2));
    if (columns != squares.width && columns == squares.height)
        throw Failure(cv::format("the markers of this ChArUco board are in %d columns of squares: give --size=%dx%d, columns before rows",
                                 columns, squares.height - 1, squares.width - 1));
    if (columns > 0 && columns != squares.width)
        throw Failure(cv::format("the markers of this ChArUco board are in %d columns of squares, not in the %d of --size=%dx%d: give %d "
                                 "columns of inner corners", columns, squares.width, squares.width - 1, squares.height - 1, columns - 1));
    if (columns == squares.width)
        throw Failure(cv::format("this ChArUco board has a marker in the first corner, which OpenCV's boards with an odd number of rows of "
                                 "squares do not have (%d with --size=%dx%d): count the rows; with an odd number of inner ones, --legacy",
                                 squares.height, squares.width - 1, squares.height - 1));
}

#if !REFRACT_OPENCV_AT_LEAST_4_7
using CharucoBoard = cv::aruco::CharucoBoard;

//! The markers next to an inner corner, and which of their corners is nearest to it.
void findNearest(CharucoBoard& board, double square)
{
    for (size_t i = 0; i < board.chessboardCorners.size(); i++)
    {
        const cv::Point3f corner = board.chessboardCorners[i];
        board.nearestMarkerIdx[i].clear();
        board.nearestMarkerCorners[i].clear();
        for (size_t j = 0; j < board.objPoints.size(); j++)
        {
            const std::vector<cv::Point3f>& marker = board.objPoints[j];
            const cv::Point3f middle = (marker[0] + marker[2])*0.5f;
            if (std::abs(middle.x - corner.x) > square || std::abs(middle.y - corner.y) > square)
                continue;
            const auto nearer = [&](const cv::Point3f& a, const cv::Point3f& b) { return cv::norm(a - corner) < cv::norm(b - corner); };
            board.nearestMarkerIdx[i].push_back((int)j);
            board.nearestMarkerCorners[i].push_back((int)(std::min_element(marker.begin(), marker.end(), nearer) - marker.begin()));
        }
    }
}

cv::Ptr<CharucoBoard> boardOf(cv::Size innerCorners, double square, double marker, int dictionary, bool legacy = false)
{
    const cv::Size squares = squaresOf(innerCorners);
    const cv::Ptr<CharucoBoard> board = CharucoBoard::create(squares.width, squares.height, (float)square, (float)marker,
                                                             cv::aruco::getPredefinedDictionary(dictionary));
    if (!legacy || squares.height % 2 == 1)
        return board;
    const std::vector<cv::Point> places = markerSquares(squares, true);
    const cv::Point other = markerSquares(squares, false)[0];
    const std::vector<cv::Point3f> first = board->objPoints[0];
    board->objPoints.assign(places.size(), first);
    board->ids.resize(places.size());
    for (size_t j = 0; j < places.size(); j++)
    {
        board->ids[j] = (int)j;
        for (cv::Point3f& corner : board->objPoints[j])
            corner += cv::Point3f((float)((places[j].x - other.x)*square), (float)((places[j].y - other.y)*square), 0);
    }
    findNearest(*board, square);
    return board;
}
#endif

} // namespace

void requireMarkers(cv::Size innerCorners, int dictionary)
{
#if REFRACT_OPENCV_AT_LEAST_4_7
    const int markers = cv::aruco::getPredefinedDictionary(dictionary).bytesList.rows;
#else
    const int markers = cv::aruco::getPredefinedDictionary(dictionary)->bytesList.rows;
#endif
    const int needed = squaresOf(innerCorners).area()/2;
    if (needed > markers)
        throw Failure(cv::format("--dictionary has %d markers, a board of this --size needs %d: take the dictionary that the "
                                 "board was printed with", markers, needed));
}

cv::Mat drawCharuco(cv::Size innerCorners, double square, double marker, int dictionary, int pixelsPerSquare)
{
    cv::Mat image;
    const cv::Size size = squaresOf(innerCorners)*pixelsPerSquare;
#if REFRACT_OPENCV_AT_LEAST_4_7
    const cv::aruco::CharucoBoard board(squaresOf(innerCorners), (float)square, (float)marker,
                                        cv::aruco::getPredefinedDictionary(dictionary));
    board.generateImage(size, image);
#else
    boardOf(innerCorners, square, marker, dictionary)->draw(size, image);
#endif
    return image;
}

cv::Mat charucoModules(cv::Size innerCorners, int dictionary)
{
#if REFRACT_OPENCV_AT_LEAST_4_7
    const int bits = cv::aruco::getPredefinedDictionary(dictionary).markerSize;
#else
    const int bits = cv::aruco::getPredefinedDictionary(dictionary)->markerSize;
#endif
    const int perSquare = bits + 4, pixels = 5;         // of a module, whose middle is looked at
    const cv::Mat image = drawCharuco(innerCorners, perSquare, perSquare - 2, dictionary, perSquare*pixels);
    cv::Mat modules(squaresOf(innerCorners)*perSquare, CV_8U);
    for (int row = 0; row < modules.rows; row++)
        for (int column = 0; column < modules.cols; column++)
            modules.at<uchar>(row, column) = image.at<uchar>(row*pixels + pixels/2, column*pixels + pixels/2);
    return modules;
}

std::vector<cv::Point2d> detectCharuco(const cv::Mat& grey, cv::Size innerCorners, double square, double marker,
                                       int dictionary, bool legacy)
{
    std::vector<cv::Point2f> corners;
    std::vector<int> ids, markerIds;
    MarkerCorners markerCorners;
#if REFRACT_OPENCV_AT_LEAST_4_7
    cv::aruco::CharucoBoard board(squaresOf(innerCorners), (float)square, (float)marker,
                                  cv::aruco::getPredefinedDictionary(dictionary));
    board.setLegacyPattern(legacy);
    cv::aruco::CharucoDetector(board).detectBoard(grey, corners, ids, markerCorners, markerIds);
#else
    const auto markers = cv::aruco::getPredefinedDictionary(dictionary);
    const auto board = boardOf(innerCorners, square, marker, dictionary, legacy);
    cv::aruco::detectMarkers(grey, markers, markerCorners, markerIds);
    if (!markerIds.empty())
        cv::aruco::interpolateCornersCharuco(markerCorners, markerIds, grey, board, corners, ids);
#endif
    requireLayout(markerCorners, markerIds, squaresOf(innerCorners), legacy);
    if (ids.size() < 4)
        return {};
    // OpenCV's own refinement ends up to half a pixel off. The nearest other edge is the marker's.
    refineCorners(grey, corners, 0.5*(1 - marker/square));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<cv::Point2d> points(innerCorners.area(), cv::Point2d(nan, nan));
    for (size_t i = 0; i < ids.size(); i++)
        points.at(ids[i]) = corners[i];
    return points;
}

} // namespace tools
