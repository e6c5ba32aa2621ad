// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/near_origin.hpp"
#include "math/rotation.hpp"
#include "pose/poses.hpp"

namespace cv { namespace refract {

NearOrigin::NearOrigin(const std::vector<Point3d>& points)
{
    if (!isNear(points))
        origin_ = points[0];
}

bool NearOrigin::isNear(const std::vector<Point3d>& points) const
{
    const double FAR = 10;          // times the target's size: what is nearer loses a digit at most
    Vec3d centroid;
    for (const Point3d& p : points)
        centroid += Vec3d(p)*(1./(double)points.size());
    double size = 0;
    for (const Point3d& p : points)
        size = std::max(size, norm(Vec3d(p) - centroid));
    return !(norm(centroid - origin_) > FAR*size);
}

void NearOrigin::move(std::vector<Point3d>& points) const
{
    for (Point3d& p : points)
        p -= Point3d(origin_);
}

NearOrigin moveNear(ImagePoints& points)
{
    const NearOrigin origin(points.object);
    origin.move(points.object);
    return origin;
}

Pose NearOrigin::toNear(Pose pose) const
{
    if (isMoved())
        pose.tvec += rotationMatrix(pose.rvec)*origin_;
    return pose;
}

Pose NearOrigin::toFar(Pose pose, double scale) const
{
    if (isMoved())
        pose.tvec -= scale*(rotationMatrix(pose.rvec)*origin_);
    return pose;
}

Matx66d NearOrigin::byOther(const Pose& pose, double sign) const
{
    Matx66d derivatives = Matx66d::eye();
    const Matx33d turn = Rotation(pose.rvec.val).derivativeOf(origin_);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            derivatives(3 + i, j) = sign*turn(i, j);
    return derivatives;
}

}} // namespace
