// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/nearest_rays.hpp"
#include "math/least_squares.hpp"
#include "math/rotation.hpp"
#include "pose/generalized_p3p.hpp"

namespace cv { namespace refract {

namespace {

//! Distances of points from their rays, by the depth that they have at the start.
struct RayErrors
{
    RayErrors(const Camera& camera, const ImagePoints& points, const Pose& start) : object(points.object), rays(camera, points)
    {
        const RigidTransform motion = transformOf(start);
        for (size_t k = 0; k < rays.ray.size(); k++)
        {
            const Vec3d X = motion.apply(Vec3d(object[rays.point[k]]));
            weight.push_back(1/norm(X - rays.ray[k].origin));
        }
    }

    bool operator()(const Vec6d& pose, SumOfSquares<6>& sum) const
    {
        const Rotation turn(pose.val);
        for (size_t k = 0; k < rays.ray.size(); k++)
        {
            const Vec3d X(object[rays.point[k]]), d = rays.ray[k].direction;
            const Matx33d across = weight[k]*(Matx33d::eye() - d*d.t()), byRvec = across*turn.derivativeOf(X);
            const Vec3d error = across*(turn.R*X + Vec3d(pose.val + 3) - rays.ray[k].origin);
            for (int r = 0; r < 3; r++)
            {
                const double byPose[6] = { byRvec(r, 0), byRvec(r, 1), byRvec(r, 2), across(r, 0), across(r, 1), across(r, 2) };
                sum.add(error[r], byPose);
            }
        }
        return true;
    }

    const std::vector<Point3d>& object;
    PointRays rays;
    std::vector<double> weight;     //!< of a ray
};

} // namespace

Pose nearestToRays(const Camera& camera, const ImagePoints& points, const Pose& start)
{
    const LeastSquaresEnd end = { 50, 1e-20, 1e-12 };       // squared radians; a start
    Vec6d six(start.rvec[0], start.rvec[1], start.rvec[2], start.tvec[0], start.tvec[1], start.tvec[2]);
    minimizeSquares(RayErrors(camera, points, start), end, six);
    Pose pose = start;
    pose.rvec = Vec3d(six.val);
    pose.tvec = Vec3d(six.val + 3);
    return pose;
}

}} // namespace
