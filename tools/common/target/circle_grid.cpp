// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/circle_grid.hpp"
#include "target/limited_search.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>

using namespace cv;

namespace tools {

namespace {

const int SECONDS = 20;     // of processor time: the detector may take minutes for nothing

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

//! Centres, then as many points whose x is a diameter. The largest dot that can fit decides the blob detector's limits.
std::vector<Point2f> findDots(const Mat& grey, Size size, bool asymmetric)
{
    SimpleBlobDetector::Params limits;
    limits.maxArea = std::max(limits.maxArea, (float)(grey.total()/size.area()));
    const int flags = asymmetric ? CALIB_CB_ASYMMETRIC_GRID : CALIB_CB_SYMMETRIC_GRID;
    for (const uchar colour : {0, 255})
    {
        limits.blobColor = colour;
        const auto detector = SimpleBlobDetector::create(limits);
        for (const int extra : {0, (int)CALIB_CB_CLUSTERING})
        {
            std::vector<Point2f> found;
            if (!findCirclesGrid(grey, size, found, flags | extra, detector))
                continue;
            std::vector<KeyPoint> blobs;
            detector->detect(grey, blobs);
            const std::vector<Point2f> diameters = diametersAt(found, blobs);
            found.insert(found.end(), diameters.begin(), diameters.end());
            return found;
        }
    }
    return {};
}

//! Where the dots are on the board, in units of --square.
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

//! Board -> image near a dot, to second order.
struct LocalMap
{
    Matx22d first;
    Vec2d xx, xy, yy;           //!< second derivatives
};

//! From the dots nearest to one.
LocalMap localMap(const std::vector<Vec2d>& grid, const std::vector<Point2f>& centres, size_t at)
{
    const size_t NEAREST = 16;
    std::vector<size_t> near(grid.size());
    std::iota(near.begin(), near.end(), 0);
    std::stable_sort(near.begin(), near.end(), [&](size_t a, size_t b) { return norm(grid[a] - grid[at]) < norm(grid[b] - grid[at]); });
    near.resize(std::min(near.size(), NEAREST));
    Mat_<double> terms((int)near.size(), 6), pixels((int)near.size(), 2), c;
    for (int i = 0; i < terms.rows; i++)
    {
        const Vec2d d = grid[near[i]] - grid[at];
        const double row[] = {1., d[0], d[1], 0.5*d[0]*d[0], d[0]*d[1], 0.5*d[1]*d[1]};
        std::copy(row, row + 6, terms[i]);
        pixels(i, 0) = centres[near[i]].x;
        pixels(i, 1) = centres[near[i]].y;
    }
    solve(terms, pixels, c, DECOMP_SVD);
    return {Matx22d(c(1, 0), c(2, 0), c(1, 1), c(2, 1)), Vec2d(c(3, 0), c(3, 1)), Vec2d(c(4, 0), c(4, 1)), Vec2d(c(5, 0), c(5, 1))};
}

/** From the image of a disc's centre to the middle of the disc's image, for a squared radius of 1: the mean over the disc of
board -> image, weighted by how much image a piece of the board has. */
Vec2d offsetOf(const LocalMap& map)
{
    const Matx22d inverse = map.first.inv();
    const auto trace2 = [&](const Vec2d& byX, const Vec2d& byY) {      // of inverse*[byX byY]: how the area changes
        return inverse(0, 0)*byX[0] + inverse(0, 1)*byX[1] + inverse(1, 0)*byY[0] + inverse(1, 1)*byY[1]; };
    const Vec2d growth(trace2(map.xx, map.xy), trace2(map.xy, map.yy));
    return 0.25*(0.5*(map.xx + map.yy) + map.first*growth);
}

/** Of a board seen at an angle the middle of a dot's image is not the image of its centre: tenths of a pixel, all in one direction.
The neighbours say how the board is seen, the blobs how large the dots are. */
std::vector<Point2d> imagesOfCentres(const std::vector<Point2f>& centres, const std::vector<Point2f>& diameters,
                                     const std::vector<Vec2d>& grid)
{
    const size_t FEWEST = 9;
    const double RIM = 0.5;         // pixels: a blob's contour runs through the middles of its outermost pixels
    std::vector<Point2d> images(centres.begin(), centres.end());
    std::vector<LocalMap> maps;
    std::vector<double> radii;      // squared, on the board
    for (size_t i = 0; i < images.size() && images.size() >= FEWEST; i++)
    {
        maps.push_back(localMap(grid, centres, i));
        if (diameters[i].x > 0)
            radii.push_back(std::pow(0.5*diameters[i].x + RIM, 2)/std::abs(determinant(maps[i].first)));
    }
    if (radii.empty())
        return images;
    std::nth_element(radii.begin(), radii.begin() + radii.size()/2, radii.end());
    for (size_t i = 0; i < images.size(); i++)
        images[i] -= Point2d(radii[radii.size()/2]*offsetOf(maps[i]));
    return images;
}

} // namespace

std::vector<Point2d> detectCircleGrid(const Mat& grey, Size size, bool asymmetric)
{
    const std::vector<Point2f> found = searchLimited(SECONDS, 2*size.area(), [&] { return findDots(grey, size, asymmetric); });
    const auto middle = found.begin() + found.size()/2;
    return imagesOfCentres({found.begin(), middle}, {middle, found.end()}, gridOf(size, asymmetric));
}

} // namespace tools
