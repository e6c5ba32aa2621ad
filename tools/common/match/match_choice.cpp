// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/match_choice.hpp"

#include <algorithm>
#include <cmath>
#include <map>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int ACROSS = 8, DEEP = 4;         // cells
const double SAME = 2.;                 // px

int firstCamera(const Matches& matches, int point)
{
    int c = 0;
    while (!matches.isSeen(c, point))
        c++;
    return c;
}

double scaleOf(const ScaledMatches& all, int point)
{
    double largest = 0.;
    for (int c = 0; c < all.matches.cameraCount(); c++)
        if (all.matches.isSeen(c, point))
            largest = std::max(largest, all.scales[c][point]);
    return largest;
}

//! Ranks of depths, from 0 to 1; those without one are in the middle.
std::vector<double> ranksOfDepth(const Matches& matches, const RigModel& rig)
{
    const std::vector<Point3d> points = triangulate(rig, matches.pixels, TRIANGULATE_MIDPOINT);
    std::vector<double> sorted;
    for (const Point3d& X : points)
        if (std::isfinite(X.z))
            sorted.push_back(X.z);
    std::sort(sorted.begin(), sorted.end());
    std::vector<double> ranks;
    for (const Point3d& X : points)
        ranks.push_back(!std::isfinite(X.z) ? 0.5
                        : (double)(std::lower_bound(sorted.begin(), sorted.end(), X.z) - sorted.begin())/sorted.size());
    return ranks;
}

//! Matches by where they are in their first image.
class Places
{
public:
    explicit Places(const Matches& matches) : matches_(matches) {}

    //! One that was added is at the same place in all images, and is as the condition has it.
    template<typename Condition> bool hasSame(int point, const Condition& condition) const
    {
        const Key key = keyOf(point);
        for (int y = -1; y <= 1; y++)
            for (int x = -1; x <= 1; x++)
            {
                const auto cell = cells_.find({key[0], key[1] + x, key[2] + y});
                if (cell != cells_.end() && std::any_of(cell->second.begin(), cell->second.end(), [&](int other) {
                        return condition(other) && isSame(point, other); }))
                    return true;
            }
        return false;
    }
    void add(int point) { cells_[keyOf(point)].push_back(point); }

private:
    typedef std::array<int, 3> Key;
    Key keyOf(int point) const
    {
        const int c = firstCamera(matches_, point);
        const Point2d p = matches_.pixels[c][point];
        return {c, (int)std::floor(p.x/SAME), (int)std::floor(p.y/SAME)};
    }
    bool isSame(int a, int b) const
    {
        for (int c = 0; c < matches_.cameraCount(); c++)
            if (matches_.isSeen(c, a) && matches_.isSeen(c, b) && norm(matches_.pixels[c][a] - matches_.pixels[c][b]) > SAME)
                return false;
        return true;
    }

    const Matches& matches_;
    std::map<Key, std::vector<int>> cells_;
};

} // namespace

void ScaledMatches::add(const ScaledMatches& others)
{
    const int cameras = others.matches.cameraCount();
    matches.pixels.resize(cameras);
    scales.resize(cameras);
    unlike.insert(unlike.end(), others.unlike.begin(), others.unlike.end());
    matches.names.insert(matches.names.end(), others.matches.names.begin(), others.matches.names.end());
    for (int c = 0; c < cameras; c++)
    {
        matches.pixels[c].insert(matches.pixels[c].end(), others.matches.pixels[c].begin(), others.matches.pixels[c].end());
        scales[c].insert(scales[c].end(), others.scales[c].begin(), others.scales[c].end());
    }
}

ScaledMatches ScaledMatches::only(const std::vector<int>& points) const
{
    ScaledMatches part;
    part.matches.pixels.resize(matches.cameraCount());
    part.matches.stds.resize(matches.stds.size());
    part.scales.resize(scales.size());
    for (int i : points)
    {
        part.matches.names.push_back(matches.names[i]);
        if (!unlike.empty())
            part.unlike.push_back(unlike[i]);
        for (int c = 0; c < matches.cameraCount(); c++)
        {
            part.matches.pixels[c].push_back(matches.pixels[c][i]);
            part.scales[c].push_back(scales[c][i]);
            if (!matches.stds.empty())
                part.matches.stds[c].push_back(matches.stds[c][i]);
        }
    }
    return part;
}

std::vector<uchar> recurring(const ScaledMatches& all)
{
    Places places(all.matches);
    for (int i = 0; i < all.size(); i++)
        places.add(i);
    std::vector<uchar> recurs;
    for (int i = 0; i < all.size(); i++)
        recurs.push_back(places.hasSame(i, [&](int other) { return all.matches.names[other].image != all.matches.names[i].image; }));
    return recurs;
}

std::vector<int> spreadChoice(const ScaledMatches& all, const RigModel& rig, int count)
{
    const std::vector<double> ranks = ranksOfDepth(all.matches, rig);
    std::vector<int> order;
    for (int i = 0; i < all.size(); i++)
        order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return scaleOf(all, a) < scaleOf(all, b); });
    Places taken(all.matches);
    std::map<std::array<int, 4>, int> inCell;
    std::vector<std::pair<int, int>> chosen;        // how many its cell had before, and which
    for (int i : order)
    {
        if (taken.hasSame(i, [](int) { return true; }))
            continue;
        taken.add(i);
        const int c = firstCamera(all.matches, i);
        const Size size = rig.cameras[c]->imageSize();
        const auto cell = [](double share, int cells) { return std::min(cells - 1, (int)(share*cells)); };
        const Point2d p = all.matches.pixels[c][i];
        chosen.push_back({inCell[{c, cell(p.x/size.width, ACROSS), cell(p.y/size.height, ACROSS), cell(ranks[i], DEEP)}]++, i});
    }
    std::stable_sort(chosen.begin(), chosen.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<int> points;
    for (int i = 0; i < std::min(count, (int)chosen.size()); i++)
        points.push_back(chosen[i].second);
    std::sort(points.begin(), points.end());
    return points;
}

} // namespace tools
