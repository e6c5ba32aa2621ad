// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/circle_grid.hpp"
#include "console/numbers.hpp"
#include "target/dot_lattice.hpp"
#include "target/refine_points.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;

namespace tools {

namespace {

//! Diameters of the dots at some centres; 0 where no blob is.
std::vector<Point2f> diametersAt(const std::vector<Point2f>& centres, const std::vector<KeyPoint>& blobs)
{
    std::vector<Point2f> diameters;
    for (const Point2f& centre : centres)
    {
        const auto blob = std::find_if(blobs.begin(), blobs.end(), [&](const KeyPoint& b) { return norm(b.pt - centre) < 0.5; });
        diameters.emplace_back(blob == blobs.end() ? 0.f : blob->size, 0.f);
    }
    return diameters;
}

//! Of a grid of which some dots are covered, or larger than others; empty: none. NaN where a dot is missing.
std::vector<Point2f> gridOfBlobs(const std::vector<KeyPoint>& blobs, Size size, bool asymmetric)
{
    const DotLattice lattice = findLattice(blobs);
    const std::vector<int> dots = dotsOfGrid(asymmetric ? asAsymmetric(lattice) : lattice, gridOf(size, asymmetric));
    std::vector<Point2f> centres;
    for (int dot : dots)
        centres.push_back(dot < 0 ? Point2f(NAN, NAN) : blobs[dot].pt);
    return centres;
}

//! Centres, then as many points whose x is a diameter. The largest dot that can fit decides the blob detector's limits.
std::vector<Point2f> findDots(const Mat& grey, Size size, bool asymmetric)
{
    SimpleBlobDetector::Params limits;
    limits.maxArea = std::max(limits.maxArea, (float)(grey.total()/size.area()));
    const int flags = asymmetric ? CALIB_CB_ASYMMETRIC_GRID : CALIB_CB_SYMMETRIC_GRID;
    const auto isInTime = [](size_t blobs, size_t most) { return blobs > 0 && blobs <= most; };     // it grows with the cube of the number
    for (const uchar colour : {0, 255})
    {
        limits.blobColor = colour;
        std::vector<Point2f> found, centres;
        std::vector<KeyPoint> blobs;
        SimpleBlobDetector::create(limits)->detect(grey, blobs);
        KeyPoint::convert(blobs, centres);
        if (!isInTime(blobs.size(), 500) || !findCirclesGrid(centres, size, found, flags, nullptr))
            found = gridOfBlobs(blobs, size, asymmetric);
        if (found.empty() && (!isInTime(blobs.size(), 2000)
                              || !findCirclesGrid(centres, size, found, flags | CALIB_CB_CLUSTERING, nullptr)))
            continue;
        const std::vector<Point2f> diameters = diametersAt(found, blobs);
        found.insert(found.end(), diameters.begin(), diameters.end());
        return found;
    }
    return {};
}

/** Board -> image: a homography, and what lens and window add to it, a polynomial of a degree that the dots allow. */
class BoardMap
{
public:
    BoardMap(const std::vector<Vec2d>& grid, const std::vector<Point2d>& centres)
        : degree_(grid.size() < 12 ? 0 : grid.size() < 30 ? 3 : 4)
    {
        Mat mean;
        reduce(Mat(grid).reshape(1), mean, 0, REDUCE_AVG);
        middle_ = Vec2d(mean.ptr<double>());
        for (const Vec2d& g : grid)
            scale_ = std::max(scale_, norm(g - middle_));
        std::vector<Point2d> places;
        for (const Vec2d& g : grid)
            places.emplace_back((g - middle_)/scale_);
        homography_ = findHomography(places, centres);
        Mat_<double> terms, rest((int)grid.size(), 2);
        for (size_t i = 0; i < places.size(); i++)
        {
            terms.push_back(Mat(termsAt(places[i])).reshape(1, 1));
            const Vec2d off = Vec2d(centres[i].x, centres[i].y) - throughHomography(places[i]);
            rest((int)i, 0) = off[0];
            rest((int)i, 1) = off[1];
        }
        solve(terms, rest, coefficients_, DECOMP_SVD);
    }

    Point2d at(const Vec2d& board) const
    {
        const Point2d place((board - middle_)/scale_);
        const Mat_<double> added = Mat(termsAt(place)).reshape(1, 1)*coefficients_;
        return Point2d(throughHomography(place)) + Point2d(added(0), added(1));
    }

private:
    Vec2d throughHomography(const Point2d& p) const
    {
        const Vec3d h = homography_*Vec3d(p.x, p.y, 1);
        return Vec2d(h[0]/h[2], h[1]/h[2]);
    }
    std::vector<double> termsAt(const Point2d& p) const
    {
        std::vector<double> terms;
        for (int i = 0; i <= degree_; i++)
            for (int j = 0; i + j <= degree_; j++)
                terms.push_back(std::pow(p.x, i)*std::pow(p.y, j));
        return terms;
    }

    int degree_;
    Vec2d middle_;
    double scale_ = 0.;
    Matx33d homography_;
    Mat_<double> coefficients_;
};

//! Area and middle of the image of a disc.
struct DiscImage
{
    double area;
    Point2d middle;
};

DiscImage discImage(const BoardMap& map, const Vec2d& centre, double radius)
{
    const int CORNERS = 48;
    const Point2d origin = map.at(centre);
    std::vector<Point2d> rim;
    for (int i = 0; i < CORNERS; i++)
        rim.push_back(map.at(centre + radius*Vec2d(std::cos(2*CV_PI*i/CORNERS), std::sin(2*CV_PI*i/CORNERS))) - origin);
    double twice = 0.;
    Point2d sum;
    for (int i = 0; i < CORNERS; i++)
    {
        const Point2d &p = rim[i], &q = rim[(i + 1) % CORNERS];
        twice += p.cross(q);
        sum += p.cross(q)*(p + q);
    }
    return {0.5*std::abs(twice), origin + sum*(1/(3*twice))};
}

/** Of the dots on the board, from the areas of their images: the usual one, or their own where they are not as large as the others, as
marks of the middle or of a corner are. Empty: there are no areas. */
std::vector<double> dotRadii(const BoardMap& map, const std::vector<Vec2d>& grid, const std::vector<double>& areas)
{
    const double TRIAL = 0.3, ALIKE = 0.2;       // of the distance between dots; of a radius
    std::vector<double> radii, known;
    for (size_t i = 0; i < grid.size(); i++)
    {
        radii.push_back(TRIAL*std::sqrt(areas[i]/discImage(map, grid[i], TRIAL).area));
        if (areas[i] > 0)
            known.push_back(radii.back());
    }
    if (known.empty())
        return {};
    const double usual = median(known);
    for (double& radius : radii)
        if (!(radius > 0) || std::abs(radius/usual - 1) < ALIKE)
            radius = usual;
    return radii;
}

//! The ellipse to which a board maps a disc, to first order.
DotImage dotAt(const BoardMap& map, const Vec2d& centre, double radius)
{
    const double STEP = 0.01;
    const Point2d x = map.at(centre + Vec2d(STEP, 0)) - map.at(centre - Vec2d(STEP, 0));
    const Point2d y = map.at(centre + Vec2d(0, STEP)) - map.at(centre - Vec2d(0, STEP));
    return {map.at(centre), (Matx22d(x.x, y.x, x.y, y.y)*(0.5*radius/STEP)).inv()};
}

//! How far from a dot's centre there is no other one, in its radii. One that is large, or thought to be, is in the way of those beside it.
double reachOf(size_t dot, const std::vector<Vec2d>& grid, const std::vector<double>& radii)
{
    const double RIM = 0.1;         // of a radius, that is left to the next dot
    double room = INFINITY;
    for (size_t i = 0; i < grid.size(); i++)
        if (i != dot)
            room = std::min(room, norm(grid[i] - grid[dot]) - radii[i]);
    return room/radii[dot] - RIM;
}

/** Of a board seen at an angle the middle of a dot's image is not the image of its centre: tenths of a pixel, all in one direction.
All dots together say how the board is seen, their areas how large they are. */
std::vector<Point2d> imagesOfCentres(const Mat& grey, const std::vector<Point2d>& blobs, std::vector<double> areas,
                                     const std::vector<Vec2d>& grid)
{
    const size_t FEWEST = 9;
    if (blobs.size() < FEWEST)
        return blobs;
    const BoardMap roughly(grid, blobs);
    const std::vector<double> radii = dotRadii(roughly, grid, areas);
    if (radii.empty())
        return blobs;
    std::vector<DotImage> dots;
    std::vector<double> reach;
    for (size_t i = 0; i < blobs.size(); i++)
    {
        dots.push_back(dotAt(roughly, grid[i], radii[i]));
        dots[i].centre = blobs[i];
        reach.push_back(reachOf(i, grid, radii));
    }
    refineDots(grey, dots, reach);
    std::vector<Point2d> centres;
    for (size_t i = 0; i < dots.size(); i++)
    {
        centres.push_back(dots[i].centre);
        areas[i] = dots[i].area();
    }
    const BoardMap map(grid, centres);
    const std::vector<double> exactly = dotRadii(map, grid, areas);
    for (size_t i = 0; i < dots.size(); i++)
        centres[i] -= discImage(map, grid[i], exactly[i]).middle - map.at(grid[i]);
    return centres;
}

} // namespace

std::vector<Vec2d> gridOf(Size size, bool asymmetric)
{
    std::vector<Vec2d> grid;
    for (int i = 0; i < size.area(); i++)
    {
        const int row = i/size.width, column = i % size.width;
        grid.emplace_back(asymmetric ? 2*column + row % 2 : column, row);
    }
    return grid;
}

std::vector<Point2d> detectCircleGrid(const Mat& grey, Size size, bool asymmetric)
{
    const std::vector<Point2f> found = findDots(grey, size, asymmetric);
    const std::vector<Vec2d> grid = gridOf(size, asymmetric);
    std::vector<Point2d> blobs;
    std::vector<double> areas;
    std::vector<Vec2d> places;
    for (size_t i = 0; 2*i < found.size(); i++)
        if (found[i].x == found[i].x)
        {
            const double diameter = found[found.size()/2 + i].x;
            blobs.push_back(found[i]);
            areas.push_back(0.25*CV_PI*diameter*diameter);
            places.push_back(grid[i]);
        }
    const std::vector<Point2d> centres = imagesOfCentres(grey, blobs, areas, places);
    std::vector<Point2d> points;
    for (size_t i = 0, next = 0; 2*i < found.size(); i++)
        points.push_back(found[i].x == found[i].x ? centres[next++] : Point2d(NAN, NAN));
    return points;
}

} // namespace tools
