// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/board_line.hpp"
#include <algorithm>
#include <cmath>
#include <set>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double BEYOND = 1.5;              // squares that the board reaches beyond the outermost corners that are seen
const double EDGE_PX = 3.;              // an edge's colours reach so far
const double LARGEST_DOT = 7./6.;       // of the radius that dots are drawn with
const double CANDIDATE_PX = 1.5;        // distance of a candidate's points from its line
const double ALIGNED = 0.9;             // cosine between a point's own direction and its line
const int CANDIDATES = 5, SAMPLES = 1500, FEWEST = 20;      // of a line, in pixels along it

//! Where rays meet the board's plane: in camera 1 and on the board.
struct OnBoard
{
    std::vector<Point3d> inCamera;
    std::vector<Point2d> onBoard;

    OnBoard(const Calibration& calibration, const BoardImage& image, const std::vector<Point2d>& pixels)
    {
        refractivePointsOnPlane(pixels, inCamera, calibration.cameras[0].camera, image.plane);
        const Matx33d toBoard = image.pose.rotation().t();
        for (const Point3d& X : inCamera)
        {
            const Vec3d p = toBoard*(Vec3d(X) - image.pose.tvec);
            onBoard.emplace_back(p[0], p[1]);
        }
    }
};

Rect2d boardArea(const Target& target, const std::vector<Point2d>& pixels)
{
    std::vector<Point2f> seenPoints;
    for (size_t i = 0; i < pixels.size(); i++)
        if (seen(pixels[i]))
            seenPoints.emplace_back((float)target.objectPoints()[i].x, (float)target.objectPoints()[i].y);
    double left = INFINITY, top = INFINITY, right = -INFINITY, bottom = -INFINITY;
    for (const Point2f& p : seenPoints)
    {
        left = std::min(left, (double)p.x);
        right = std::max(right, (double)p.x);
        top = std::min(top, (double)p.y);
        bottom = std::max(bottom, (double)p.y);
    }
    const double margin = BEYOND*target.square();
    return Rect2d(left - margin, top - margin, right - left + 2*margin, bottom - top + 2*margin);
}

double distanceToGrid(double coordinate, double square)
{
    return std::abs(coordinate - square*std::round(coordinate/square));
}

//! Within some pixels of an edge of the pattern. @param pixel its size on the board
bool isNearEdge(const Target& target, const Point2d& p, double pixel)
{
    switch (target.pattern())
    {
    case Target::CHESSBOARD:
    case Target::CHARUCO:
        return std::min(distanceToGrid(p.x, target.square()), distanceToGrid(p.y, target.square())) < EDGE_PX*pixel;
    case Target::CIRCLES:
    case Target::ACIRCLES:
    case Target::DOTS:
    case Target::APRILGRID:         // refract_laser refuses it
        break;
    }
    return std::any_of(target.objectPoints().begin(), target.objectPoints().end(), [&](const Point3d& dot) {
        return norm(p - Point2d(dot.x, dot.y)) < LARGEST_DOT*target.dotRadius() + EDGE_PX*pixel; });
}

//! Pixels by which a point is off a line on the board. @param normal of the line
double pixelsOff(const BoardImage& image, const BoardPoint& p, const Point2d& start, const Vec2d& normal)
{
    const Vec3d across = image.pose.rotation().t()*p.byAcross;
    const double perPixel = normal[0]*across[0] + normal[1]*across[1];
    return (normal[0]*(p.onBoard.x - start.x) + normal[1]*(p.onBoard.y - start.y))/perPixel;
}

//! The points of the line through two of them.
std::vector<int> pointsOfLine(const BoardImage& image, const std::vector<int>& among, int first, int second)
{
    const Point2d start = image.points[first].onBoard, end = image.points[second].onBoard;
    const Vec2d along = Vec2d(end - start)/norm(end - start), normal(-along[1], along[0]);
    std::vector<int> line;
    for (int i : among)
    {
        const BoardPoint& p = image.points[i];
        if (std::abs(p.alongOnBoard.dot(along)) > ALIGNED && std::abs(pixelsOff(image, p, start, normal)) < CANDIDATE_PX)
            line.push_back(i);
    }
    return line;
}

//! Pixels of an image that a line's points cover, along the longer of its sides.
int lengthOf(const BoardImage& image, const std::vector<int>& line)
{
    std::set<int> columns, rows;
    for (int i : line)
    {
        columns.insert(cvRound(image.points[i].ridge.pixel.x));
        rows.insert(cvRound(image.points[i].ridge.pixel.y));
    }
    return (int)std::max(columns.size(), rows.size());
}

//! By random samples of two points, of which bright ones are the likelier.
std::vector<int> longestLine(const BoardImage& image, const std::vector<int>& among, double square, RNG& rng)
{
    std::vector<double> sums;
    double sum = 0.;
    for (int i : among)
        sums.push_back(sum += std::sqrt(image.points[i].ridge.curvature));
    const auto draw = [&] {
        const auto at = std::upper_bound(sums.begin(), sums.end(), rng.uniform(0., sum));
        return among[std::min((size_t)(at - sums.begin()), among.size() - 1)];
    };
    std::vector<int> best;
    int length = 0;
    for (int k = 0; k < SAMPLES; k++)
    {
        const int first = draw(), second = draw();
        const BoardPoint &a = image.points[first], &b = image.points[second];
        const Vec2d chord(b.onBoard - a.onBoard);
        if (norm(chord) < 0.5*square || std::abs(a.alongOnBoard.dot(chord)) < ALIGNED*norm(chord) ||
            std::abs(b.alongOnBoard.dot(chord)) < ALIGNED*norm(chord))
            continue;
        const std::vector<int> line = pointsOfLine(image, among, first, second);
        if ((int)line.size() <= length)
            continue;
        const int covered = lengthOf(image, line);
        if (covered > length)
        {
            best = line;
            length = covered;
        }
    }
    return length < FEWEST ? std::vector<int>() : best;
}

void findCandidates(BoardImage& image, double square)
{
    RNG rng(1);         // the same input gives the same bytes
    std::vector<int> among(image.points.size());
    for (size_t i = 0; i < among.size(); i++)
        among[i] = (int)i;
    while ((int)image.candidates.size() < CANDIDATES && among.size() >= FEWEST)
    {
        const std::vector<int> line = longestLine(image, among, square, rng);
        if (line.empty())
            break;
        image.candidates.push_back(line);
        std::vector<int> rest;
        std::set_difference(among.begin(), among.end(), line.begin(), line.end(), std::back_inserter(rest));
        among = rest;
    }
}

} // namespace

BoardImage findLinesOnBoard(const std::string& name, const Calibration& calibration, const Target& target,
                            const std::vector<Point2d>& pixels, const Mat& signal, double scale)
{
    BoardImage image;
    image.name = name;
    image.pose = poseOfTarget(calibration, target.objectPoints(), pixels);
    const Matx33d R = image.pose.rotation();
    const Vec3d normal(R(0, 2), R(1, 2), R(2, 2));
    image.plane = Vec4d(normal[0], normal[1], normal[2], normal.dot(image.pose.tvec));
    const std::vector<RidgePoint> ridges = findRidges(signal, scale, noiseOf(signal));
    std::vector<Point2d> at, across, along;
    for (const RidgePoint& r : ridges)
    {
        at.push_back(r.pixel);
        across.push_back(r.pixel + Point2d(r.across));
        along.push_back(r.pixel + Point2d(-r.across[1], r.across[0]));
    }
    if (ridges.empty())
        return image;
    const OnBoard points(calibration, image, at), acrossThem(calibration, image, across), alongThem(calibration, image, along);
    const Rect2d area = boardArea(target, pixels);
    for (size_t i = 0; i < ridges.size(); i++)
    {
        const Vec2d step(alongThem.onBoard[i] - points.onBoard[i]);
        const Vec3d byAcross(acrossThem.inCamera[i] - points.inCamera[i]);
        if (!area.contains(points.onBoard[i]) || !(norm(step) > 0.) || !(norm(byAcross) > 0.)       // false for NaN
            || isNearEdge(target, points.onBoard[i], norm(byAcross)))
            continue;
        image.points.push_back({ridges[i], points.inCamera[i], points.onBoard[i], step/norm(step), byAcross});
    }
    findCandidates(image, target.square());
    return image;
}

} // namespace tools
