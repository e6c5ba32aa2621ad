// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/wand_matches.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

using namespace cv;
using namespace cv::refract;

namespace tools {

BallCenter centerOfBall(const Ptr<RefractiveCamera>& camera, const DotImage& outline, const Point3d& near)
{
    const int RIM = 16, ROUNDS = 4;
    const BallCenter none = {outline.centre, std::numeric_limits<double>::quiet_NaN()};
    const Matx22d fromCircle = outline.toCircle.inv();
    std::vector<Point2d> rim;
    for (int i = 0; i < RIM; i++)
        rim.push_back(outline.centre + Point2d(fromCircle*Vec2d(std::cos(2*CV_PI*i/RIM), std::sin(2*CV_PI*i/RIM))));
    std::vector<Point3d> origins, directions;
    refractiveUnprojectPoints(rim, origins, directions, camera);
    Vec3d along, origin;
    for (int i = 0; i < RIM; i++)
    {
        along += Vec3d(directions[i])/RIM;
        origin += Vec3d(origins[i])/RIM;
    }
    if (!(norm(along) > 0))
        return none;
    along = normalize(along);
    const Matx32d across = tangents(along);
    const Vec3d right(across.col(0).val), down(across.col(1).val);
    Vec3d center = origin + along*along.dot(Vec3d(near) - origin);
    double radius = 0.;
    for (int round = 0; round < ROUNDS; round++)
    {
        Matx33d H;
        Vec3d g, step;
        for (int i = 0; i < RIM; i++)
        {
            const Vec3d d(directions[i]), from = center - Vec3d(origins[i]), away = from - d*d.dot(from);
            const double distance = norm(away);
            const Vec3d row(away.dot(right)/distance, away.dot(down)/distance, -1);
            H += row*row.t();
            g += row*(radius - distance);
        }
        if (!solve(H, g, step, DECOMP_CHOLESKY))
            return none;
        center += step[0]*right + step[1]*down;
        radius += step[2];
    }
    std::vector<Point2d> pixel;
    refractiveProjectPoints(std::vector<Point3d>{Point3d(center)}, Vec3d(), Vec3d(), camera, pixel);
    return std::isfinite(pixel[0].x) && radius > 0 ? BallCenter{pixel[0], radius} : none;
}

static const double NaN = std::numeric_limits<double>::quiet_NaN();

std::vector<WandPlace> WandFinder::places(const Wand& wand, const WandLimits& limits) const
{
    const std::vector<BallPoint> points = pointsWithin(limits.rms);
    std::vector<WandPlace> places;
    for (size_t i = 0; i < points.size(); i++)
        for (size_t k = 0; k < i; k++)
            if (!points[i].sharesBallWith(points[k]))
            {
                const bool first = points[i].radius > points[k].radius;
                const WandPlace place = {points[first ? i : k], points[first ? k : i]};
                if (std::abs(place.length()/wand.length - 1) < limits.length)
                    places.push_back(place);
            }
    std::sort(places.begin(), places.end(), [](const WandPlace& p, const WandPlace& q) {
        return p.count() != q.count() ? p.count() > q.count() : p.rms() < q.rms(); });
    return places;
}

std::vector<Chain> WandFinder::pairs() const
{
    std::vector<Chain> chains;
    for (int c = 0; c < cameras(); c++)
        for (int k = 0; k < c; k++)
            for (int i = 0; i < (int)balls_[c].size(); i++)
                for (int j = 0; j < (int)balls_[k].size(); j++)
                {
                    chains.push_back(Chain(cameras(), -1));
                    chains.back()[c] = i;
                    chains.back()[k] = j;
                }
    return chains;
}

std::vector<BallPoint> WandFinder::triangulated(const std::vector<Chain>& chains) const
{
    std::vector<std::vector<Point2d>> pixels(cameras());
    for (const Chain& chain : chains)
        for (int c = 0; c < cameras(); c++)
            pixels[c].push_back(chain[c] < 0 ? Point2d(NaN, NaN) : balls_[c][chain[c]].outline.centre);
    if (chains.empty())
        return {};
    Mat_<double> errors;
    const std::vector<Point3d> X = triangulate(rig_, pixels, cv::refract::TRIANGULATE_OPTIMAL, errors);
    std::vector<BallPoint> points;
    for (int i = 0; i < (int)chains.size(); i++)
    {
        BallPoint point = {chains[i], X[i]};
        for (int c = 0; c < cameras(); c++)
            if (chains[i][c] >= 0)
            {
                point.squares += errors(i, c)*errors(i, c);
                point.count++;
            }
        if (std::isfinite(point.squares))
            points.push_back(point);
    }
    return points;
}

//! With what the other cameras see near its projections.
Chain WandFinder::extended(const BallPoint& point, double reach) const
{
    Chain chain = point.balls;
    for (int c = 0; c < cameras(); c++)
    {
        if (chain[c] >= 0 || balls_[c].empty())
            continue;
        std::vector<Point2d> pixel;
        refractiveProjectPoints(std::vector<Point3d>{point.X}, rig_.extrinsics[c].R, rig_.extrinsics[c].t, rig_.cameras[c], pixel);
        double nearest = reach;
        for (int i = 0; i < (int)balls_[c].size(); i++)
        {
            const double away = norm(balls_[c][i].outline.centre - pixel[0]);
            if (away < nearest)
                nearest = away, chain[c] = i;
        }
    }
    return chain;
}

//! Where the ball's centre is seen, and whether it is equally large to all cameras.
bool WandFinder::measure(BallPoint& point) const
{
    const double ALIKE = 1.6;
    double least = INFINITY, most = 0.;
    point.centers.assign(cameras(), Point2d(NaN, NaN));
    for (int c = 0; c < cameras(); c++)
        if (point.balls[c] >= 0)
        {
            const BallCenter center = centerOfBall(rig_.cameras[c], balls_[c][point.balls[c]].outline,
                                                   Point3d(rig_.extrinsics[c].apply(Vec3d(point.X))));
            point.centers[c] = center.pixel;
            point.radius += center.radius/point.count;
            least = std::min(least, center.radius);
            most = std::max(most, center.radius);
        }
    return point.radius == point.radius && most < ALIKE*least;
}

std::vector<BallPoint> WandFinder::pointsWithin(double tolerance) const
{
    const double FARTHER = 3.;          // a point of two cameras may be off along their rays
    const auto near = [&](std::vector<BallPoint> points) {
        points.erase(std::remove_if(points.begin(), points.end(), [&](const BallPoint& p) { return !(p.rms() < tolerance); }),
                     points.end());
        return points;
    };
    std::vector<Chain> chains = pairs();
    std::set<Chain> all;
    for (const BallPoint& point : near(triangulated(chains)))
    {
        all.insert(point.balls);
        all.insert(extended(point, FARTHER*tolerance));
    }
    std::vector<BallPoint> points = near(triangulated({all.begin(), all.end()})), result;
    for (BallPoint& point : points)
        if (std::none_of(points.begin(), points.end(), [&](const BallPoint& other) { return point.isPartOf(other); })
            && measure(point))
            result.push_back(point);
    return result;
}

} // namespace tools
