// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/moved_rig.hpp"
#include "assess/change.hpp"
#include "match/depth_range.hpp"
#include "math/dense.hpp"
#include "measure/distributions.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/rig_vector.hpp"
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double DEGREE = CV_PI/180.;

bool isTurn(const Change& change)
{
    return std::all_of(change.quantities.begin(), change.quantities.end(), [](const ChangedQuantity& q) { return q.unit == "degrees"; });
}

//! The parameters of the rig by those of all changes of the table, a column each, in their standard deviations; of these 0: not at all.
MatrixXd byChanges(const RigModel& rig, const Vec3d& middle, const std::function<VectorXd(const Change&)>& stdsOf)
{
    const double SMALL = 1e-3;          // of the range; cv::Rodrigues takes turns below 1e-5 for none
    std::vector<VectorXd> columns;
    for (const Change& change : changesOf(rig, "", middle))
    {
        const VectorXd stds = stdsOf(change), steps = SMALL*change.ranges();
        for (int i = 0; i < change.size(); i++)
        {
            if (!(stds[i] > 0.))
                continue;
            VectorXd values[2];
            for (int side : {0, 1})
            {
                RigModel moved = rig.clone();
                change.apply(moved, (side ? steps[i] : -steps[i])*VectorXd::Unit(change.size(), i));
                values[side] = parametersOf(moved);
            }
            columns.push_back(stds[i]*(values[1] - values[0])/(2.*steps[i]));
        }
    }
    MatrixXd D(parametersOf(rig).size(), columns.size());
    for (size_t i = 0; i < columns.size(); i++)
        D.col(i) = columns[i];
    return D;
}

MatrixXd byTurns(const RigModel& rig, const MayHaveTurned& turned)
{
    return byChanges(rig, Vec3d(0, 0, 1), [&](const Change& change) {
        const double std = !isTurn(change) ? 0. : change.isTilt || change.isAxis ? turned.windows : turned.ofCamera(change.turnedCamera());
        return VectorXd(VectorXd::Constant(change.size(), std*DEGREE)); });
}

//! The calibration's covariance with what may have changed since, independently, a column each.
Mat covarianceWith(const CheckInput& input, const MatrixXd& changes)
{
    MatrixXd C = input.covariance.empty() ? MatrixXd(MatrixXd::Zero(changes.rows(), changes.rows())) : toEigen(input.covariance);
    addGram(changes.transpose(), 1., C);
    C.triangularView<Eigen::StrictlyUpper>() = C.transpose();
    return toMat(C);
}

//! Points all over what both cameras see.
std::vector<Point3d> pointsInBoth(const RigModel& rig, int first, int second, const Vec2d& depth)
{
    const int STEPS = 6, DEPTHS = 3;
    const double FAR = 100.;            // times the near end: farther points look as those
    std::vector<Point3d> both;
    for (int k = 0; k < DEPTHS; k++)
    {
        const double far = std::min(depth[1], FAR*depth[0]), share = k/(DEPTHS - 1.);
        const std::vector<Point3d> points = pointsAtDepth(rig.cameras[0], 1./((1. - share)/depth[0] + share/far), STEPS);
        std::vector<Point3d> kept;
        std::copy_if(points.begin(), points.end(), std::back_inserter(kept), [](const Point3d& X) { return X.x == X.x; });
        const std::vector<int> seen1 = pointsInImage(rig, kept, Vec3d(), Vec3d(), first, true).points;
        const std::vector<int> seen2 = pointsInImage(rig, kept, Vec3d(), Vec3d(), second, true).points;
        for (int i : seen1)
            if (std::binary_search(seen2.begin(), seen2.end(), i))
                both.push_back(kept[i]);
    }
    return both;
}

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
        refractiveProjectPoints(points, rotationVector(rig.extrinsics[c].R), rig.extrinsics[c].t, rig.cameras[c], predicted);
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

Mat covarianceOfMoved(const CheckInput& input, const MayHaveTurned& turned)
{
    return covarianceWith(input, byTurns(input.rig, turned));
}

Mat covarianceOfChanged(const CheckInput& input, double depth, double share)
{
    return covarianceWith(input, byChanges(input.rig, Vec3d(0, 0, depth), [&](const Change& change) {
        return VectorXd(share*change.ranges()); }));
}

double searchWidth(const CheckInput& input, int first, int second, const Vec2d& depth, double degrees)
{
    const double MANY = 3., NOISE = 3.;         // standard deviations; px, of features
    const std::vector<Point3d> points = pointsInBoth(input.rig, first, second, depth);
    const int count = (int)points.size();
    std::vector<int> all(count);
    for (int i = 0; i < count; i++)
        all[i] = i;
    const ViewDerivatives view = differentiateView(input.rig, points, Vec3d(), Vec3d(), {{first, true, all}, {second, true, all}});
    const MatrixXd D = byTurns(input.rig, {{degrees}, degrees});
    const MatrixXd C = input.covariance.empty() ? MatrixXd(MatrixXd::Zero(D.rows(), D.rows())) : toEigen(input.covariance);
    double width = 0.;
    for (int i = 0; i < count; i++)
    {
        MatrixXd byPoint(4, 3), byParameters(4, view.byParameters.cols());
        byPoint << view.byPose.block(2*i, 3, 2, 3), view.byPose.block(2*(count + i), 3, 2, 3);
        byParameters << view.byParameters.middleRows(2*i, 2), view.byParameters.middleRows(2*(count + i), 2);
        const VectorXd miss = QR(byPoint).Q().col(3);           // what no motion of the point does to its four coordinates
        const VectorXd row = transposeTimesVector(byParameters, miss);
        const double known = std::sqrt(std::max(0., row.dot(timesVector(C, row))));
        const double turned = transposeTimesVector(D, row).cwiseAbs().maxCoeff();
        const double inSecond = miss.tail(2).norm();
        if (inSecond > 0. && std::isfinite(known))
            width = std::max(width, (MANY*known + turned)/inSecond);
    }
    return width + NOISE;
}

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
