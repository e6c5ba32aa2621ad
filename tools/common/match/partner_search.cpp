// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/partner_search.hpp"
#include "match/depth_range.hpp"
#include <opencv2/core/hal/hal.hpp>
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <map>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double CLEARLY_NEARER = 0.8;      // than the second best elsewhere, as Lowe has it
const double ELSEWHERE = 4.;            // px: what is nearer is the same detail, in another direction or scale
const double TOLERANCE = 0.5;           // px, of curves

//! Features by where they are.
class Cells
{
public:
    Cells(const Features& features, Size size, double side)
        : side_(std::max(1., side)), columns_((int)(size.width/side_) + 1), rows_((int)(size.height/side_) + 1), lists_(columns_*rows_)
    {
        for (int i = 0; i < features.size(); i++)
        {
            const Point cell = cellOf(features.pixels[i]);
            if (isInside(cell))
                lists_[cell.y*columns_ + cell.x].push_back(i);
        }
    }

    //! Calls with all that is within one side of a place, and some more.
    template<typename Visit> void visitNear(const Point2d& place, const Visit& visit) const
    {
        const Point middle = cellOf(place);
        for (int y = middle.y - 1; y <= middle.y + 1; y++)
            for (int x = middle.x - 1; x <= middle.x + 1; x++)
                if (isInside(Point(x, y)))
                    for (int i : lists_[y*columns_ + x])
                        visit(i);
    }

private:
    Point cellOf(const Point2d& place) const
    {
        const double FARTHEST = 1e6;
        const auto cell = [&](double at) { return (int)std::floor(std::max(-FARTHEST, std::min(FARTHEST, at/side_))); };
        return Point(cell(place.x), cell(place.y));
    }
    bool isInside(const Point& cell) const { return cell.x >= 0 && cell.y >= 0 && cell.x < columns_ && cell.y < rows_; }

    const double side_;
    const int columns_, rows_;
    std::vector<std::vector<int>> lists_;
};

double distanceToSegment(const Point2d& p, const Point2d& from, const Point2d& to)
{
    const Point2d along = to - from;
    const double length2 = along.dot(along), at = length2 > 0. ? (p - from).dot(along)/length2 : 0.;
    return norm(p - from - std::min(1., std::max(0., at))*along);
}

//! Features near a curve, each once, in ascending order.
std::vector<int> nearCurve(const Mat& curve, const Features& features, const Cells& cells, double search)
{
    std::vector<int> near;
    for (int i = 0; i < curve.rows; i++)
    {
        const Point2d from = curve.at<Point2d>(std::max(0, i - 1)), to = curve.at<Point2d>(i);
        const int steps = (int)std::min(10000., norm(to - from)/search) + 1;
        for (int k = 0; k <= steps; k++)
            cells.visitNear(from + (double)k/steps*(to - from), [&](int feature) {
                if (distanceToSegment(features.pixels[feature], from, to) <= search)
                    near.push_back(feature);
            });
    }
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    return near;
}

//! The best so far, and the best elsewhere.
struct Choice
{
    int partner = -1;
    float best = FLT_MAX, second = FLT_MAX;

    void offer(int candidate, float distance, const std::vector<Point2d>& places)
    {
        const bool isSame = partner >= 0 && norm(places[candidate] - places[partner]) < ELSEWHERE;
        if (distance < best)
        {
            if (!isSame)
                second = best;
            best = distance;
            partner = candidate;
        }
        else if (!isSame)
            second = std::min(second, distance);
    }
    bool isClear() const { return partner >= 0 && best < CLEARLY_NEARER*CLEARLY_NEARER*second; }
};

//! Squared, of two rows of descriptors.
class Distance
{
public:
    Distance(const Features& first, const Features& second)
        : first_(first.descriptors), second_(second.descriptors), areBits_(normOf(first) == NORM_HAMMING) {}

    float operator()(int i, int j) const
    {
        if (!areBits_)
            return hal::normL2Sqr_(first_.ptr<float>(i), second_.ptr<float>(j), first_.cols);
        const float bits = (float)hal::normHamming(first_.ptr(i), second_.ptr(j), first_.cols);
        return bits*bits;
    }

private:
    const Mat first_, second_;
    const bool areBits_;
};

//! z in the frame of a camera of all that camera 1 sees within a range of depths.
Vec2d depthInCamera(const RigModel& rig, int c, const Vec2d& depth)
{
    if (c == 0)
        return depth;
    const int STEPS = 4;
    const double FAR = 1e3;             // times the near end: what is beyond is endless
    Vec2d range(DBL_MAX, 0.);
    for (double z : {depth[0], std::min(depth[1], FAR*depth[0])})
        for (const Point3d& X : pointsAtDepth(rig.cameras[0], z, STEPS))
        {
            const double there = rig.extrinsics[c].apply(Vec3d(X))[2];
            if (there > 0.)             // false for NaN
                range = Vec2d(std::min(range[0], there), std::max(range[1], there));
        }
    if (!(range[1] > 0.))
        return Vec2d(depth[0], DBL_MAX);
    return Vec2d(range[0], depth[1] > FAR*depth[0] ? DBL_MAX : range[1]);
}

//! Sets of nodes that are joined two by two.
class Sets
{
public:
    explicit Sets(int count) : parent_(count)
    {
        for (int i = 0; i < count; i++)
            parent_[i] = i;
    }
    int find(int node)
    {
        while (parent_[node] != node)
            node = parent_[node] = parent_[parent_[node]];
        return node;
    }
    void join(int a, int b) { parent_[find(a)] = find(b); }

private:
    std::vector<int> parent_;
};

//! Of each feature the first at its place.
std::vector<int> firstAtPlace(const Features& features)
{
    std::map<std::pair<double, double>, int> places;
    std::vector<int> first;
    for (int i = 0; i < features.size(); i++)
        first.push_back(places.insert({{features.pixels[i].x, features.pixels[i].y}, i}).first->second);
    return first;
}

} // namespace

CameraPair::CameraPair(const RigModel& rig, int first_, int second_, const Vec2d& depth_, double search_)
    : first(first_), second(second_), depth(depthInCamera(rig, first_, depth_)), search(search_)
{
}

FeaturePairs partnersNearCurves(const RigModel& rig, const CameraPair& pair, const Features& first, const Features& second)
{
    if (first.size() == 0 || second.size() == 0)
        return {};
    const RigidTransform place = fromTo(rig.extrinsics[pair.first], rig.extrinsics[pair.second]);
    std::vector<Mat> curves;
    computeRefractiveEpilines(first.pixels, 1, rig.cameras[pair.first], rig.cameras[pair.second], place.R, place.t, pair.depth, curves,
                              TOLERANCE);
    const Cells cells(second, rig.cameras[pair.second]->imageSize(), pair.search);
    const Distance distanceOf(first, second);
    std::vector<Choice> forth(first.size()), back(second.size());
    for (int i = 0; i < first.size(); i++)
        for (int j : nearCurve(curves[i], second, cells, pair.search))
        {
            const float distance = distanceOf(i, j);
            forth[i].offer(j, distance, second.pixels);
            back[j].offer(i, distance, first.pixels);
        }
    FeaturePairs pairs;
    for (int i = 0; i < first.size(); i++)
        if (forth[i].isClear() && back[forth[i].partner].isClear() && back[forth[i].partner].partner == i)
            pairs.push_back({i, forth[i].partner});
    return pairs;
}

std::vector<Chain> chainsOf(const std::vector<Features>& features, const std::vector<PairMatches>& matches)
{
    const int cameras = (int)features.size();
    std::vector<int> begin = {0};
    std::vector<std::vector<int>> first;
    for (const Features& ofCamera : features)
    {
        begin.push_back(begin.back() + ofCamera.size());
        first.push_back(firstAtPlace(ofCamera));
    }
    Sets sets(begin.back());
    for (const PairMatches& m : matches)
        for (const auto& pair : m.pairs)
            sets.join(begin[m.first] + first[m.first][pair.first], begin[m.second] + first[m.second][pair.second]);
    const int CONTRADICTION = -2;
    std::map<int, Chain> chains;
    for (int c = 0; c < cameras; c++)
        for (int i = 0; i < features[c].size(); i++)
        {
            if (first[c][i] != i)
                continue;
            int& at = chains.insert({sets.find(begin[c] + i), Chain(cameras, -1)}).first->second[c];
            at = at == -1 ? i : CONTRADICTION;
        }
    std::vector<Chain> result;
    for (const auto& chain : chains)
    {
        int seen = 0;
        bool contradicts = false;
        for (int i : chain.second)
        {
            seen += i >= 0;
            contradicts |= i == CONTRADICTION;
        }
        if (seen > 1 && !contradicts)
            result.push_back(chain.second);
    }
    return result;
}

} // namespace tools
