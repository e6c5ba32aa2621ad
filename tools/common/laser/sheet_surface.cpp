// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/sheet_surface.hpp"
#include "calibrate/rigid_transform.hpp"
#include "measure/point_derivatives.hpp"
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

SheetDistances distancesFromPlane(const Vec4d& plane, const std::vector<Point3d>& points)
{
    const Eigen::Index count = (Eigen::Index)points.size();
    const Eigen::RowVector3d n(plane[0], plane[1], plane[2]);
    SheetDistances d = {VectorXd(count), n.replicate(count, 1), MatrixXd(count, 4)};
    for (Eigen::Index i = 0; i < count; i++)
    {
        const Point3d& X = points[i];
        d.byState.row(i) << X.x, X.y, X.z, -1.;
        d.e[i] = n.dot(Eigen::RowVector3d(X.x, X.y, X.z)) - plane[3];
    }
    return d;
}

SheetDistances distancesFromEmitter(const Emitter& emitter, const std::vector<Point3d>& points)
{
    const Eigen::Index count = (Eigen::Index)points.size();
    const Vec3d rvec = rotationVector(emitter.R), T = emitter.translation();
    std::vector<Point2d> pixels;
    refractiveProjectPoints(points, rvec, T, emitter.camera, pixels);
    const PointDerivatives by = differentiatePoints(emitter.camera, points, rvec, T);
    const Eigen::Index parameters = by.byParameters.cols();
    SheetDistances d = {VectorXd(count), MatrixXd(count, 3), MatrixXd(count, 6 + parameters)};
    for (Eigen::Index i = 0; i < count; i++)
    {
        const Vec3d g(by.byPose(2*i, 3), by.byPose(2*i, 4), by.byPose(2*i, 5));     // of u, by the point in the emitter's frame
        const Vec3d byPoint = emitter.R.t()*g, byRotation = (emitter.R*(Vec3d(points[i]) - emitter.position)).cross(g);
        const double perUnit = 1/norm(g);
        d.e[i] = (pixels[i].x - emitter.line)*perUnit;
        for (int k = 0; k < 3; k++)
        {
            d.byPoint(i, k) = byPoint[k]*perUnit;
            d.byState(i, k) = byRotation[k]*perUnit;
            d.byState(i, 3 + k) = -byPoint[k]*perUnit;
        }
        d.byState.row(i).tail(parameters) = by.byParameters.row(2*i)*perUnit;
    }
    return d;
}

//! Two tangents of the normal, and d.
MatrixXd PlaneSurface::basis() const
{
    const Vec3d n(plane_.val), other = std::abs(n[0]) < 0.7 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    const Vec3d b1 = normalize(n.cross(other)), b2 = n.cross(b1);
    MatrixXd basis = MatrixXd::Zero(4, 3);
    for (int i = 0; i < 3; i++)
        basis.row(i) << b1[i], b2[i], 0.;
    basis(3, 2) = 1.;
    return basis;
}

std::shared_ptr<const SheetSurface> PlaneSurface::moved(const VectorXd& step) const
{
    const VectorXd by = basis()*step;
    const Vec4d plane = plane_ + Vec4d(by[0], by[1], by[2], by[3]);
    return std::make_shared<PlaneSurface>(plane/norm(Vec3d(plane.val)), coefficients_);
}

std::shared_ptr<const SheetSurface> EmitterSurface::moved(const VectorXd& step) const
{
    return std::make_shared<EmitterSurface>(*prior_, prior_->moved(emitter_, step));
}

} // namespace tools
