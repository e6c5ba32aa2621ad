// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/charuco.hpp"
#include "console/failure.hpp"
#include "target/refine_corners.hpp"

#include <opencv2/core/version.hpp>
#include <limits>
#include <map>

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

#if !REFRACT_OPENCV_AT_LEAST_4_7
cv::Ptr<cv::aruco::CharucoBoard> boardOf(cv::Size innerCorners, double square, double marker, int dictionary)
{
    const cv::Size squares = squaresOf(innerCorners);
    return cv::aruco::CharucoBoard::create(squares.width, squares.height, (float)square, (float)marker,
                                           cv::aruco::getPredefinedDictionary(dictionary));
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
                                       int dictionary)
{
    std::vector<cv::Point2f> corners;
    std::vector<int> ids;
#if REFRACT_OPENCV_AT_LEAST_4_7
    const cv::aruco::CharucoBoard board(squaresOf(innerCorners), (float)square, (float)marker,
                                        cv::aruco::getPredefinedDictionary(dictionary));
    cv::aruco::CharucoDetector(board).detectBoard(grey, corners, ids);
#else
    const auto markers = cv::aruco::getPredefinedDictionary(dictionary);
    const auto board = boardOf(innerCorners, square, marker, dictionary);
    std::vector<std::vector<cv::Point2f>> markerCorners;
    std::vector<int> markerIds;
    cv::aruco::detectMarkers(grey, markers, markerCorners, markerIds);
    if (!markerIds.empty())
        cv::aruco::interpolateCornersCharuco(markerCorners, markerIds, grey, board, corners, ids);
#endif
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
