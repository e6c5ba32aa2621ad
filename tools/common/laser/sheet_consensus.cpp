// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/sheet_consensus.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;

namespace tools {

namespace {

const double AGREE_PX = 4.;             // of most points of a line, as two boards make a plane that is a little off elsewhere

struct Line
{
    int image;
    const std::vector<int>* points;
    Point3d ends[2];
};

double medianOff(const BoardImage& image, const std::vector<int>& points, const Vec4d& plane)
{
    std::vector<double> off;
    for (int i : points)
        off.push_back(std::abs(pixelsOffPlane(image.points[i], plane)));
    std::nth_element(off.begin(), off.begin() + off.size()/2, off.end());
    return off[off.size()/2];
}

std::vector<Line> linesOf(const std::vector<BoardImage>& images)
{
    std::vector<Line> lines;
    for (size_t m = 0; m < images.size(); m++)
        for (const std::vector<int>& points : images[m].candidates)
        {
            const auto far = [&](const Point3d& from) {
                const auto farther = [&](int a, int b) {
                    return norm(images[m].points[a].inCamera - from) < norm(images[m].points[b].inCamera - from); };
                return images[m].points[*std::max_element(points.begin(), points.end(), farther)].inCamera;
            };
            const Point3d end = far(images[m].points[points[0]].inCamera);
            lines.push_back({(int)m, &points, {end, far(end)}});
        }
    return lines;
}

//! Of least squares through four points.
Vec4d planeThrough(const Line& a, const Line& b)
{
    const Point3d points[] = {a.ends[0], a.ends[1], b.ends[0], b.ends[1]};
    const Point3d middle = (points[0] + points[1] + points[2] + points[3])*0.25;
    Mat rows(4, 3, CV_64F);
    for (int i = 0; i < 4; i++)
        Mat(Vec3d(points[i] - middle)).reshape(1, 1).copyTo(rows.row(i));
    const SVD svd(rows);
    const Vec3d normal(svd.vt.ptr<double>(2));
    return Vec4d(normal[0], normal[1], normal[2], normal.dot(Vec3d(middle)));
}

//! How many pixels of lines are on a plane, at most one line an image.
double scoreOf(const std::vector<BoardImage>& images, const std::vector<Line>& lines, const Vec4d& plane)
{
    std::vector<size_t> best(images.size(), 0);
    for (const Line& line : lines)
        if (line.points->size() > best[line.image] && medianOff(images[line.image], *line.points, plane) < AGREE_PX)
            best[line.image] = line.points->size();
    double score = 0.;
    for (size_t points : best)
        score += std::sqrt((double)points);     // many images rather than long lines
    return score;
}

} // namespace

double pixelsOffPlane(const BoardPoint& point, const Vec4d& plane)
{
    const Vec3d n(plane[0], plane[1], plane[2]);
    return (n.dot(Vec3d(point.inCamera)) - plane[3])/n.dot(point.byAcross);
}

Vec3d intersectionOf(const BoardImage& image, const Vec4d& plane)
{
    const Vec3d along = Vec3d(image.plane.val).cross(Vec3d(plane.val));
    return norm(along) > 0. ? along/norm(along) : Vec3d();
}

Vec4d planeOfMostLines(const std::vector<BoardImage>& images)
{
    const std::vector<Line> lines = linesOf(images);
    Vec4d best;
    double most = 0.;
    for (size_t a = 0; a < lines.size(); a++)
        for (size_t b = a + 1; b < lines.size(); b++)
        {
            if (lines[a].image == lines[b].image)
                continue;
            const Vec4d plane = planeThrough(lines[a], lines[b]);
            if (medianOff(images[lines[a].image], *lines[a].points, plane) > AGREE_PX ||
                medianOff(images[lines[b].image], *lines[b].points, plane) > AGREE_PX)
                continue;
            const double score = scoreOf(images, lines, plane);
            if (score > most)
            {
                most = score;
                best = plane;
            }
        }
    return best;
}

} // namespace tools
