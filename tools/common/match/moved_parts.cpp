// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/moved_parts.hpp"
#include "measure/distributions.hpp"
#include "measure/eigen_matrix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double RARE = 1e-4;               // of parts that stand still
const int LEAST = 8, MOST_CENTRES = 200;        // matches of a part; parts of a size

//! pixel - projection of each match in all cameras, in standard deviations, a column each; 0: not seen.
MatrixXd missesOf(const ScaledMatches& scaled, const RigModel& rig, const std::vector<MatchResidual>& residuals, const MatchNoise& noise)
{
    const Matches& matches = scaled.matches;
    const std::vector<Point3d> points = triangulate(rig, matches.pixels, TRIANGULATE_OPTIMAL);
    MatrixXd misses = MatrixXd::Zero(2*matches.cameraCount(), scaled.size());
    for (int c = 0; c < matches.cameraCount(); c++)
    {
        std::vector<Point2d> predicted;
        refractiveProjectPoints(points, rotationVector(rig.extrinsics[c].R), rig.extrinsics[c].T, rig.cameras[c], predicted);
        for (int i = 0; i < scaled.size(); i++)
        {
            const Point2d miss = (matches.pixels[c][i] - predicted[i])*(1./std::sqrt(noise.varianceOf(residuals[i])));
            if (std::isfinite(miss.x + miss.y))         // seen, and there is a point
                misses.col(i).segment(2*c, 2) << miss.x, miss.y;
        }
    }
    return misses;
}

//! The sum of the misses of matches that err independently.
class SumOfMisses
{
public:
    SumOfMisses(const MatrixXd& misses, const std::vector<MatchResidual>& residuals, const std::vector<int>& candidates)
    {
        // Along the curves there is no miss, so that of all directions a sum of chi^2 is in few: as many as spread as much.
        MatrixXd spread = MatrixXd::Zero(misses.rows(), misses.rows());
        double count = 0.;
        for (int i : candidates)
        {
            for (Eigen::Index k = 0; k < misses.rows(); k++)
                spread.col(k) += misses(k, i)*misses.col(i);
            count += residuals[i].count;
        }
        mean_ = count/std::max<size_t>(1, candidates.size());
        const double directions = std::pow(spread.trace(), 2)/std::max(1e-300, spread.squaredNorm());
        directions_ = std::max(1, (int)directions);
    }

    bool isRare(const VectorXd& sum, int count) const
    {
        return upperTailChiSquared(directions_, sum.squaredNorm()/count*directions_/mean_) < RARE;
    }

private:
    double mean_ = 0.;          // of the squared miss of one match
    int directions_ = 1;
};

//! In the image of the first camera that saw it.
struct Place
{
    int camera;
    Point2d pixel;
};

Place placeOf(const Matches& matches, int point)
{
    int c = 0;
    while (!matches.isSeen(c, point))
        c++;
    return {c, matches.pixels[c][point]};
}

double squaredDistance(const Place& a, const Place& b)
{
    const Point2d off = a.pixel - b.pixel;
    return a.camera == b.camera ? off.dot(off) : std::numeric_limits<double>::max();
}

std::vector<Place> placesOf(const Matches& matches)
{
    std::vector<Place> places;
    for (int i = 0; i < (int)matches.names.size(); i++)
        places.push_back(placeOf(matches, i));
    return places;
}

} // namespace

std::vector<int> groupsOf(const ScaledMatches& all)
{
    const int STANDS_STILL = -1;
    const std::vector<uchar> recurs = recurring(all);
    std::map<std::string, int> moments;
    std::vector<int> groups;
    for (int i = 0; i < all.size(); i++)
        groups.push_back(recurs[i] ? STANDS_STILL : moments.insert({all.matches.names[i].image, (int)moments.size()}).first->second);
    return groups;
}

std::vector<uchar> inContradictedParts(const ScaledMatches& scaled, const RigModel& rig, const std::vector<int>& candidates)
{
    const int ACROSS = 8;               // parts
    const std::vector<Place> places = placesOf(scaled.matches);
    const auto partOf = [&](int i) {
        const Size size = rig.cameras[places[i].camera]->imageSize();
        const Point2d p = places[i].pixel;
        return std::array<int, 3>{places[i].camera, (int)(ACROSS*p.x/size.width), (int)(ACROSS*p.y/size.height)};
    };
    std::map<std::array<int, 3>, int> all, near;
    for (int i = 0; i < scaled.size(); i++)
        all[partOf(i)]++;
    for (int i : candidates)
        near[partOf(i)]++;
    std::vector<uchar> contradicted(scaled.size(), 0);
    for (int i : candidates)
        contradicted[i] = 2*near[partOf(i)] < all[partOf(i)];
    return contradicted;
}

std::vector<uchar> inMovedParts(const ScaledMatches& scaled, const std::vector<int>& groups, const RigModel& rig,
                                const std::vector<MatchResidual>& residuals, const MatchNoise& noise, const std::vector<int>& candidates)
{
    const MatrixXd misses = missesOf(scaled, rig, residuals, noise);
    const SumOfMisses test(misses, residuals, candidates);
    const std::vector<Place> places = placesOf(scaled.matches);
    std::vector<uchar> moved = inContradictedParts(scaled, rig, candidates);
    std::map<int, std::vector<int>> members;
    for (int i : candidates)
        if (!moved[i])
            members[groups[i]].push_back(i);
    for (auto& group : members)
        // Small parts first, so that what moved is not taken for a larger part.
        for (int size = LEAST; size < 2*(int)group.second.size(); size *= 2)
        {
            std::vector<int>& left = group.second;
            std::vector<int> nearest = left;
            const int count = std::min(size, (int)left.size()), step = 1 + (int)left.size()/MOST_CENTRES;
            for (size_t at = 0; count >= LEAST && at < left.size(); at += step)
            {
                const Place& centre = places[left[at]];
                std::nth_element(nearest.begin(), nearest.begin() + (count - 1), nearest.end(), [&](int a, int b) {
                    return squaredDistance(places[a], centre) < squaredDistance(places[b], centre); });
                VectorXd sum = VectorXd::Zero(misses.rows());
                for (int i = 0; i < count; i++)
                    sum += misses.col(nearest[i]);
                if (test.isRare(sum, count))
                    for (int i = 0; i < count; i++)
                        moved[nearest[i]] = 1;
            }
            left.erase(std::remove_if(left.begin(), left.end(), [&](int i) { return moved[i]; }), left.end());
        }
    return moved;
}

} // namespace tools
