// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/dot_lattice.hpp"

#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <map>

using cv::KeyPoint;
using cv::Point;
using cv::Point2f;
using cv::Size;
using cv::Vec2d;

namespace tools {

namespace {

const double NEAR = 0.3;            // of a step: so far may a dot be from where the ones beside it say
const size_t MOST_DOTS = 4000;      // of which a neighbour is looked for one by one

//! Nearest of the dots that are allowed; -1: none is within reach.
template <typename Allowed>
int nearest(const std::vector<KeyPoint>& dots, const Point2f& at, double reach, const Allowed& allowed)
{
    int best = -1;
    for (int i = 0; i < (int)dots.size(); i++)
    {
        const double distance = cv::norm(dots[i].pt - at);
        if (distance < reach && allowed(i))
        {
            reach = distance;
            best = i;
        }
    }
    return best;
}

//! Steps to the nearest dot, and to the nearest one aside of that, turned so that x, y are right and down on the front; false: none.
bool stepsAt(const std::vector<KeyPoint>& dots, int seed, Point2f steps[2])
{
    const double ASIDE = 0.6;       // sine of the angle between them, at the least
    const Point2f at = dots[seed].pt;
    const int first = nearest(dots, at, INFINITY, [&](int i) { return i != seed; });
    if (first < 0)
        return false;
    steps[0] = dots[first].pt - at;
    const double length = cv::norm(steps[0]);
    const int second = nearest(dots, at, 3*length, [&](int i) {
        const Point2f d = dots[i].pt - at;
        return i != seed && std::abs(d.cross(steps[0])) > ASIDE*length*cv::norm(d);
    });
    if (second < 0)
        return false;
    steps[1] = dots[second].pt - at;
    if (steps[0].cross(steps[1]) < 0)
        steps[1] = -steps[1];
    return true;
}

struct Placed
{
    Point place;
    int dot;
    Point2f steps[2];               //!< as they are there
};

//! From place to place, as far as there are dots.
std::vector<Placed> grow(const std::vector<KeyPoint>& dots, int seed)
{
    std::vector<Placed> found(1);
    found[0].dot = seed;
    if (!stepsAt(dots, seed, found[0].steps))
        return {};
    std::map<std::pair<int, int>, int> taken = {{{0, 0}, seed}};
    std::vector<char> used(dots.size(), 0);
    used[seed] = 1;
    for (size_t k = 0; k < found.size(); k++)
        for (int axis = 0; axis < 2; axis++)
            for (const int sign : {1, -1})
            {
                const Placed from = found[k];
                const Point place = from.place + (axis == 0 ? Point(sign, 0) : Point(0, sign));
                const Point2f step = from.steps[axis]*(float)sign, at = dots[from.dot].pt;
                const double reach = NEAR*std::min(cv::norm(from.steps[0]), cv::norm(from.steps[1]));
                const int next = taken.count({place.x, place.y}) ? -1
                                                                 : nearest(dots, at + step, reach, [&](int i) { return !used[i]; });
                if (next < 0)
                    continue;
                taken[{place.x, place.y}] = next;
                used[next] = 1;
                found.push_back({place, next, {from.steps[0], from.steps[1]}});
                found.back().steps[axis] = (dots[next].pt - at)*(float)sign;
            }
    return found;
}

//! Of its steps: beside a dot that is missing the seed's may be a diagonal.
double straightness(const std::vector<Placed>& found)
{
    return found.empty() ? 0. : std::abs(found[0].steps[0].cross(found[0].steps[1]))/cv::norm(found[0].steps[0])
        /cv::norm(found[0].steps[1]);
}

//! Places from (0, 0).
DotLattice normalised(DotLattice lattice)
{
    if (lattice.places.empty())
        return lattice;
    const cv::Rect box = cv::boundingRect(lattice.places);
    for (Point& place : lattice.places)
        place -= box.tl();
    lattice.size = box.size();
    return lattice;
}

template <typename Change>
DotLattice changed(DotLattice lattice, const Change& change)
{
    for (Point& place : lattice.places)
        place = change(place);
    return normalised(lattice);
}

/** The columns and rows of an asymmetric grid. Its rows are shifted by one against each other, so that a whole one is an even number of
places wide: where it is high by an even number, it lies on its side. */
Size sizeOfAsymmetric(Size places)
{
    if (places.width % 2 == 1 && places.height % 2 == 0)
        std::swap(places.width, places.height);
    return Size((places.width + 1)/2, places.height);
}

} // namespace

DotLattice findLattice(const std::vector<KeyPoint>& dots)
{
    const size_t SEEDS = 12;
    if (dots.empty() || dots.size() > MOST_DOTS)
        return {};
    Point2f middle;
    for (const KeyPoint& dot : dots)
        middle += dot.pt*(1.f/(float)dots.size());
    std::vector<int> seeds(dots.size());
    for (size_t i = 0; i < seeds.size(); i++)
        seeds[i] = (int)i;
    std::sort(seeds.begin(), seeds.end(), [&](int a, int b) { return cv::norm(dots[a].pt - middle) < cv::norm(dots[b].pt - middle); });
    seeds.resize(std::min(seeds.size(), SEEDS));
    std::vector<Placed> best;
    for (int seed : seeds)
    {
        const std::vector<Placed> found = grow(dots, seed);
        if (found.size() > best.size() || (found.size() == best.size() && straightness(found) > straightness(best)))
            best = found;
    }
    DotLattice lattice;
    for (const Placed& placed : best)
    {
        lattice.places.push_back(placed.place);
        lattice.dots.push_back(placed.dot);
    }
    return normalised(lattice);
}

DotLattice asAsymmetric(const DotLattice& lattice)
{
    return changed(lattice, [](const Point& p) { return Point(p.x - p.y, p.x + p.y); });
}

std::vector<int> dotsOfGrid(const DotLattice& lattice, const std::vector<Vec2d>& grid)
{
    const double LEAST = 0.75, AT_EDGE = 0.5;
    std::map<std::pair<int, int>, int> index;
    Point last;
    for (size_t i = 0; i < grid.size(); i++)
    {
        index[{(int)grid[i][0], (int)grid[i][1]}] = (int)i;
        last = Point(std::max(last.x, (int)grid[i][0]), std::max(last.y, (int)grid[i][1]));
    }
    DotLattice turned = lattice;
    for (int quarter = 0; quarter < 4; quarter++, turned = changed(turned, [](const Point& p) { return Point(-p.y, p.x); }))
    {
        std::vector<int> dots(grid.size(), -1);
        bool fits = turned.size == Size(last.x + 1, last.y + 1);
        for (size_t k = 0; fits && k < turned.places.size(); k++)
        {
            const auto place = index.find({turned.places[k].x, turned.places[k].y});
            fits = place != index.end();
            if (fits)
                dots[place->second] = turned.dots[k];
        }
        int edges[4][2] = {}, there = 0;
        for (size_t i = 0; i < grid.size(); i++)
        {
            const bool on[4] = {grid[i][0] < 1, grid[i][1] < 1, grid[i][0] > last.x - 1, grid[i][1] > last.y - 1};
            for (int e = 0; e < 4; e++)
                if (on[e])
                    edges[e][dots[i] >= 0]++;
            there += dots[i] >= 0;
        }
        for (const auto& edge : edges)
            fits = fits && edge[1] >= AT_EDGE*(edge[0] + edge[1]);
        if (fits && there >= LEAST*(double)grid.size())
            return dots;
    }
    return {};
}

Size dotGridIn(const cv::Mat& grey, bool& asymmetric)
{
    const size_t FEWEST = 12;
    const double LEAST = 0.75;
    cv::SimpleBlobDetector::Params limits;
    limits.maxArea = std::max(limits.maxArea, (float)(grey.total()/FEWEST))/4;
    limits.minArea /= 4;
    limits.minDistBetweenBlobs /= 2;
    limits.filterByCircularity = true;          // squares have 0.785
    limits.minCircularity = 0.82f;
    cv::Mat half;                               // a quarter of the time
    cv::resize(grey, half, cv::Size(), 0.5, 0.5, cv::INTER_AREA);
    for (const uchar colour : {0, 255})
    {
        limits.blobColor = colour;
        std::vector<KeyPoint> blobs;
        cv::SimpleBlobDetector::create(limits)->detect(half, blobs);
        const DotLattice lattice = findLattice(blobs);
        const DotLattice oblique = asAsymmetric(lattice);
        asymmetric = 2*oblique.filled() > lattice.filled();
        const Size straight(std::max(lattice.size.width, lattice.size.height), std::min(lattice.size.width, lattice.size.height));
        const Size size = asymmetric ? sizeOfAsymmetric(oblique.size) : straight;
        if (lattice.places.size() >= FEWEST && std::min(size.width, size.height) > 1
            && (double)lattice.places.size() >= LEAST*size.area())
            return size;
    }
    return Size();
}

} // namespace tools
