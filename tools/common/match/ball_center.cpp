// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/ball_center.hpp"

#include <cmath>
#include <limits>

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
    const Vec3d right = normalize(along.cross(std::abs(along[0]) < std::abs(along[1]) ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0)));
    const Vec3d down = normalize(along.cross(right));
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

} // namespace tools
