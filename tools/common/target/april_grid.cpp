// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/april_grid.hpp"
#include "console/failure.hpp"
#include "target/refine_points.hpp"

#include <opencv2/core/version.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#define REFRACT_OPENCV_AT_LEAST_4_7 (CV_VERSION_MAJOR*100 + CV_VERSION_MINOR >= 407)
#if REFRACT_OPENCV_AT_LEAST_4_7
#include <opencv2/objdetect/aruco_detector.hpp>
#else
#include <opencv2/aruco.hpp>
#endif

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Point2f;
using cv::Size;
using cv::Vec2d;

namespace {

const int BITS = 6, BORDER = 2, MODULES = BITS + 2*BORDER;
const int CORNERS = 4;
const size_t LEAST = 2;             // tags that make a board

typedef std::map<int, std::vector<Point2f>> Tags;       // number -> corners as OpenCV has them

//! OpenCV's tags are Kalibr's turned by half: what corner it begins with, and the next ones, as column and row of a tag's corners.
const cv::Point PLACES[CORNERS] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};

void addTags(const Mat& grey, double scale, Tags& tags)
{
    std::vector<std::vector<Point2f>> corners;
    std::vector<int> ids;
    Mat scaled = grey;
    if (scale != 1.)
        cv::resize(grey, scaled, Size(), scale, scale, cv::INTER_CUBIC);
#if REFRACT_OPENCV_AT_LEAST_4_7
    cv::aruco::DetectorParameters parameters;
    parameters.markerBorderBits = BORDER;
    cv::aruco::ArucoDetector(cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11), parameters)
        .detectMarkers(scaled, corners, ids);
#else
    const auto parameters = cv::aruco::DetectorParameters::create();
    parameters->markerBorderBits = BORDER;
    cv::aruco::detectMarkers(scaled, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11), corners, ids, parameters);
#endif
    for (size_t i = 0; i < ids.size(); i++)
    {
        for (Point2f& c : corners[i])
            c = (c + Point2f(0.5f, 0.5f))*(float)(1/scale) - Point2f(0.5f, 0.5f);
        tags.emplace(ids[i], corners[i]);
    }
}

int pointOf(Size tags, int tag, int corner)
{
    const int row = 2*(tags.height - 1 - tag/tags.width) + PLACES[corner].y, column = 2*(tag % tags.width) + PLACES[corner].x;
    return row*2*tags.width + column;
}

//! Side of the smallest tag, px.
double smallestSide(const Tags& tags)
{
    double side = INFINITY;
    for (const auto& tag : tags)
        for (int c = 0; c < CORNERS; c++)
            side = std::min(side, cv::norm(tag.second[c] - tag.second[(c + 1) % CORNERS]));
    return side;
}

//! Numbers of the tags that were found nearest to one on the board, itself not among them.
std::vector<int> tagsBeside(const Tags& found, Size tags, const std::vector<Vec2d>& grid, int tag, size_t most)
{
    std::vector<std::pair<double, int>> near;
    for (const auto& other : found)
        if (other.first != tag)
            near.push_back({cv::norm(grid[pointOf(tags, other.first, 0)] - grid[pointOf(tags, tag, 0)]), other.first});
    std::sort(near.begin(), near.end());
    std::vector<int> numbers;
    for (size_t i = 0; i < std::min(near.size(), most); i++)
        numbers.push_back(near[i].second);
    return numbers;
}

std::vector<Point2f> onBoard(Size tags, const std::vector<Vec2d>& grid, int tag)
{
    std::vector<Point2f> board;
    for (int c = 0; c < CORNERS; c++)
        board.push_back(Point2d(grid[pointOf(tags, tag, c)]));
    return board;
}

const double WRONG = 0.5;           // sides of a tag: what is elsewhere is off by more than one

//! The image to the board as most corners of some tags say. Empty: they do not tell.
Mat homographyOf(const Tags& found, Size tags, const std::vector<Vec2d>& grid, const std::vector<int>& which)
{
    std::vector<Point2f> board, pixels;
    for (int tag : which)
    {
        const std::vector<Point2f> corners = onBoard(tags, grid, tag);
        board.insert(board.end(), corners.begin(), corners.end());
        pixels.insert(pixels.end(), found.at(tag).begin(), found.at(tag).end());
    }
    return cv::findHomography(pixels, board, cv::RANSAC, WRONG);
}

//! Whether the image has the tag's modules where it must be.
bool isSeen(const Mat& grey, int tag, const std::vector<Point2f>& corners)
{
    const double ALIKE = 0.85;          // of the correlation
    const float SIDE = (float)MODULES;
    const std::vector<Point2f> square = {{SIDE, SIDE}, {0, SIDE}, {0, 0}, {SIDE, 0}};
    std::vector<Point2f> modules, pixels;
    const Mat expected = aprilTagModules(tag);
    for (int row = 0; row < MODULES; row++)
        for (int column = 0; column < MODULES; column++)
            modules.push_back(Point2f(column + 0.5f, row + 0.5f));
    cv::perspectiveTransform(modules, pixels, cv::getPerspectiveTransform(square, corners));
    cv::Mat_<float> is(1, (int)pixels.size()), should(1, (int)pixels.size());
    for (int i = 0; i < (int)pixels.size(); i++)
    {
        const cv::Point at(cvRound(pixels[i].x), cvRound(pixels[i].y));
        if (!cv::Rect(cv::Point(), grey.size()).contains(at))
            return false;
        is(i) = grey.at<uchar>(at);
        should(i) = expected.at<uchar>(i/MODULES, i % MODULES);
    }
    Mat correlation;
    cv::matchTemplate(is, should, correlation, cv::TM_CCOEFF_NORMED);
    return correlation.at<float>(0) > ALIKE;
}

//! Tags that the detector did not read, where the others say that they are.
void completeTags(const Mat& grey, Size tags, const std::vector<Vec2d>& grid, Tags& found)
{
    const size_t NEIGHBOURS = 4;
    const Tags read = found;
    for (int tag = 0; tag < tags.area(); tag++)
    {
        const Mat H = read.count(tag) ? Mat() : homographyOf(read, tags, grid, tagsBeside(read, tags, grid, tag, NEIGHBOURS));
        if (H.empty())
            continue;
        std::vector<Point2f> pixels;
        cv::perspectiveTransform(onBoard(tags, grid, tag), pixels, H.inv());
        if (isSeen(grey, tag, pixels))
            found[tag] = pixels;
    }
}

/** Whether a tag is where most of those beside it say. A lens may bend a board by half a tag, but hardly what is beside one. Of tags in
another order a row may agree with itself: so most of the tags beside it have to agree with each other, too. */
bool isInPlace(const Tags& found, Size tags, const std::vector<Vec2d>& grid, int tag)
{
    const size_t NEIGHBOURS = 8;
    const std::vector<int> beside = tagsBeside(found, tags, grid, tag, NEIGHBOURS);
    const Mat H = homographyOf(found, tags, grid, beside);
    if (H.empty())
        return false;
    const auto agrees = [&](int other) {
        std::vector<Point2f> back;
        cv::perspectiveTransform(found.at(other), back, H);
        return cv::norm(back, onBoard(tags, grid, other), cv::NORM_L2)/std::sqrt((double)CORNERS) < WRONG;
    };
    return agrees(tag) && 2*std::count_if(beside.begin(), beside.end(), agrees) > (long)beside.size();
}

//! Without tags that are none, or of another board; of a few none is left if they disagree, as nothing tells which is wrong.
Tags inPlace(const Tags& found, Size tags, const std::vector<Vec2d>& grid)
{
    const size_t TELLING = 4;           // so many that disagree are no false tags
    Tags left;
    for (const auto& tag : found)
        if (isInPlace(found, tags, grid, tag.first))
            left.insert(tag);
    const size_t wrong = found.size() - left.size();
    if (2*wrong > found.size() && wrong >= TELLING)
        throw Failure("the tags of this board are not where Kalibr puts them: tag 0 at the lower left, numbers to the right and then up; "
                      "are --size=" + std::to_string(tags.width) + "x" + std::to_string(tags.height)
                      + " (tags) and --tag-spacing those of the board?");
    return left;
}

} // namespace

std::vector<Vec2d> aprilGridOf(Size tags, double spacing)
{
    std::vector<Vec2d> grid;
    const auto at = [&](int i) { return i/2*(1 + spacing) + i % 2; };
    for (int row = 0; row < 2*tags.height; row++)
        for (int column = 0; column < 2*tags.width; column++)
            grid.emplace_back(at(column), at(row));
    return grid;
}

Mat aprilTagModules(int tag)
{
    const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11);
    Mat modules;
#if REFRACT_OPENCV_AT_LEAST_4_7
    cv::aruco::generateImageMarker(dictionary, tag, MODULES, modules, BORDER);
#else
    cv::aruco::drawMarker(dictionary, tag, MODULES, modules, BORDER);
#endif
    cv::flip(modules, modules, -1);
    return modules;
}

Mat drawAprilGrid(Size tags, double spacing, int pixelsPerTag)
{
    const int square = cvRound(spacing*pixelsPerTag);
    const double pitch = (1 + spacing)*pixelsPerTag;
    const auto edge = [&](int i) { return square + cvRound(i*pitch); };
    Mat image(edge(tags.height), edge(tags.width), CV_8U, cv::Scalar(255)), large;
    const cv::Rect all(cv::Point(), image.size());
    for (int row = 0; row <= tags.height; row++)
        for (int column = 0; column <= tags.width; column++)
        {
            image(cv::Rect(edge(column) - square, edge(row) - square, square, square) & all).setTo(0);
            if (row == tags.height || column == tags.width)
                continue;
            cv::resize(aprilTagModules((tags.height - 1 - row)*tags.width + column), large, Size(pixelsPerTag, pixelsPerTag), 0, 0,
                       cv::INTER_NEAREST);
            large.copyTo(image(cv::Rect(edge(column), edge(row), pixelsPerTag, pixelsPerTag)));
        }
    return image;
}

bool showsAprilTags(const Mat& grey)
{
    Tags found;
    addTags(grey, 1., found);
    return found.size() >= LEAST;
}

std::vector<Point2d> detectAprilGrid(const Mat& grey, Size tags, double spacing)
{
    const double REACH = 0.8*APRIL_BORDER;        // what is nearest to a corner inside of a tag are its bits
    Tags found;
    for (const double scale : {1., 2.})             // the squares join tags; in a larger image small ones come apart
        if (scale == 1. || (int)found.size() < tags.area())
            addTags(grey, scale, found);
    for (auto tag = found.begin(); tag != found.end(); )
        tag = tag->first < tags.area() ? std::next(tag) : found.erase(tag);
    if (found.size() < LEAST)
        return {};
    const std::vector<Vec2d> grid = aprilGridOf(tags, spacing);
    found = inPlace(found, tags, grid);
    if (found.size() < LEAST)
        return {};
    completeTags(grey, tags, grid, found);
    std::vector<Point2f> corners;
    std::vector<int> places;
    for (const auto& tag : found)
        for (int c = 0; c < CORNERS; c++)
        {
            corners.push_back(tag.second[c]);
            places.push_back(pointOf(tags, tag.first, c));
        }
    double nearest = INFINITY;                      // two corners, as refineCorners() has it
    for (size_t i = 0; i < corners.size(); i++)
        for (size_t j = 0; j < i; j++)
            nearest = std::min(nearest, cv::norm(corners[i] - corners[j]));
    refineCorners(grey, corners, std::min(REACH, 0.8*spacing)*smallestSide(found)/nearest);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<Point2d> points(grid.size(), Point2d(nan, nan));
    for (size_t i = 0; i < corners.size(); i++)
        points[places[i]] = corners[i];
    return points;
}

} // namespace tools
