// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/match_noise.hpp"
#include "console/numbers.hpp"
#include "measure/distributions.hpp"
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

const double RARE = 1e-4;               // of right matches: taken for a wrong one

const int NUMBERS = 3;                  // of the noise

Vec3d rowOf(const MatchResidual& r) { return Vec3d(1., r.scale2, r.scale2*r.unlike); }

Vec3d squaresOf(const MatchNoise& noise)
{
    return Vec3d(noise.floor*noise.floor, noise.share*noise.share, noise.unlikeShare*noise.unlikeShare);
}

//! x >= 0 with the least x^T H x - 2 g^T x: the best of all choices of which are 0.
Vec3d leastNonnegative(const Matx33d& H, const Vec3d& g)
{
    Vec3d best;
    double least = 0.;
    for (int choice = 1; choice < 1 << NUMBERS; choice++)
    {
        Matx33d part = H;
        Vec3d of = g;
        for (int i = 0; i < NUMBERS; i++)
            for (int k = 0; k < NUMBERS && !(choice >> i & 1); k++)
            {
                part(i, k) = part(k, i) = i == k;
                of[i] = 0.;
            }
        const Vec3d x = part.solve(of, DECOMP_SVD);
        const double value = x.dot(H*x) - 2.*g.dot(x);
        if (x[0] >= 0. && x[1] >= 0. && x[2] >= 0. && value < least)
        {
            best = x;
            least = value;
        }
    }
    return best;
}

//! A step of Fisher scoring. @param right probability of each residual that it is of a right match
MatchNoise likelierNoise(const std::vector<MatchResidual>& residuals, const std::vector<double>& right, const MatchNoise& noise)
{
    const double LEAST = 1e-12;         // px^2: exact pixels have no noise
    Matx33d H;
    Vec3d g;
    for (size_t i = 0; i < residuals.size(); i++)
    {
        const MatchResidual& r = residuals[i];
        const double v = std::max(LEAST, noise.varianceOf(r)), weight = right[i]/(v*v);
        const Vec3d row = rowOf(r);
        H += r.count*weight*(row*row.t());
        g += weight*r.squares*row;
    }
    const Vec3d x = leastNonnegative(H, g);
    return {std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2])};
}

//! Half of all residuals are below what the median of chi^2 has with it; the same at all scales.
MatchNoise noiseOfMedian(const std::vector<MatchResidual>& residuals)
{
    const double MEDIAN = 0.4549;       // of chi^2 with one degree of freedom
    std::vector<double> all;
    for (const MatchResidual& r : residuals)
        if (r.count > 0)
            all.push_back(r.squares/r.count);
    if (all.empty())
        return {};
    return {std::sqrt(median(all)/MEDIAN)};
}

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

double MatchNoise::stdOf(double scale, double unlike) const
{
    return std::sqrt(floor*floor + (share*share + unlikeShare*unlikeShare*unlike)*scale*scale);
}

double MatchNoise::varianceOf(const MatchResidual& residual) const { return squaresOf(*this).dot(rowOf(residual)); }

bool MatchResidual::isWithin(const MatchNoise& noise) const
{
    return count > 0 && (squares <= 0. || upperTailChiSquared(count, squares/noise.varianceOf(*this)) > RARE);
}

std::vector<MatchResidual> residualsOf(const ScaledMatches& scaled, const RigModel& rig)
{
    const Matches& matches = scaled.matches;
    Mat errors;
    triangulate(rig, matches.pixels, TRIANGULATE_OPTIMAL, errors);
    std::vector<MatchResidual> residuals;
    for (int i = 0; i < scaled.size(); i++)
    {
        MatchResidual r{0., 0., scaled.unlike.empty() ? 1. : scaled.unlike[i], 0};
        int cameras = 0;
        for (int c = 0; c < matches.cameraCount(); c++)
            if (matches.isSeen(c, i))
            {
                const double error = errors.at<double>(i, c);
                r.squares += error*error;
                r.scale2 += scaled.scales[c][i]*scaled.scales[c][i];
                cameras++;
            }
        r.scale2 /= cameras;
        r.count = std::isfinite(r.squares) ? 2*cameras - 3 : 0;
        residuals.push_back(r);
    }
    return residuals;
}

MatchNoise noiseOf(const std::vector<MatchResidual>& residuals)
{
    const int ROUNDS = 100;
    const double WIDE = 20., CONVERGED = 1e-4;      // standard deviations within which wrong ones are, at least
    MatchNoise noise = noiseOfMedian(residuals);
    double width2 = std::pow(WIDE*noise.floor, 2), wrongShare = 0.1;
    for (const MatchResidual& r : residuals)
        width2 = std::max(width2, r.count > 0 ? r.squares : 0.);
    if (!(noise.floor > 0.))
        return noise;
    std::vector<double> right(residuals.size());
    for (int round = 0; round < ROUNDS; round++)
    {
        double wrong = 0., all = 0.;
        for (size_t i = 0; i < residuals.size(); i++)
        {
            const MatchResidual& r = residuals[i];
            if (r.count == 0)
                continue;
            const double v = noise.varianceOf(r);
            const double ofRight = (1. - wrongShare)*std::pow(2.*CV_PI*v, -0.5*r.count)*std::exp(-0.5*r.squares/v);
            const double ofWrong = wrongShare*std::pow(4.*width2, -0.5*r.count);
            right[i] = ofRight/(ofRight + ofWrong);
            wrong += 1. - right[i];
            all++;
        }
        wrongShare = wrong/all;
        const MatchNoise better = likelierNoise(residuals, right, noise);
        const double change = norm(squaresOf(better) - squaresOf(noise))/norm(squaresOf(better));
        noise = better;
        if (!(change > CONVERGED))
            break;
    }
    return noise;
}

double unlikeLimitOf(const std::vector<MatchResidual>& residuals, const MatchNoise& noise)
{
    const int MOST_BINS = 16, ENOUGH = 50;          // matches of a bin
    const double MANY = 0.03, CERTAIN = 3.;         // of a bin miss, more than of those that look alike; standard deviations
    std::vector<const MatchResidual*> sorted;
    for (const MatchResidual& r : residuals)
        if (r.count > 0)
            sorted.push_back(&r);
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto* a, const auto* b) { return a->unlike < b->unlike; });
    const int count = (int)sorted.size(), bins = std::min(MOST_BINS, count/ENOUGH);
    const auto missing = [&](int from, int to) {
        return std::count_if(sorted.begin() + from, sorted.begin() + to, [&](const auto* r) { return !r->isWithin(noise); })
               / (double)std::max(1, to - from); };
    const double usual = missing(0, count/2), chance = CERTAIN*std::sqrt(usual*(1. - usual)*bins/std::max(1, count));
    int end = count;
    for (int bin = bins - 1; bin >= 3*bins/4 && missing(bin*count/bins, end) > usual + MANY + chance; bin--)
        end = bin*count/bins;
    return end < count && end > 0 ? sorted[end - 1]->unlike : std::numeric_limits<double>::infinity();
}

} // namespace tools
