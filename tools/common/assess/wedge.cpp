// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/wedge.hpp"
#include "calibrate/rig_model.hpp"
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! Snell's law; NaN for total reflection.
Vec3d refracted(const Vec3d& direction, const Vec3d& normal, double indexBefore, double indexAfter)
{
    const double mu = indexBefore/indexAfter, cosine = direction.dot(normal);
    return mu*direction + (std::sqrt(1. - mu*mu*(1. - cosine*cosine)) - mu*cosine)*normal;
}

} // namespace

std::vector<Point3d> traceWedge(const Ptr<RefractiveCamera>& camera, const std::vector<Point2d>& pixels, const Wedge& wedge,
                                const std::vector<double>& z)
{
    const GlassWindow window = camera->window();
    std::vector<Vec3d> origins, directions;
    refractiveUnprojectPoints(pixels, origins, directions, copyWithWindow(camera, GlassWindow()));
    std::vector<double> index = window.index;
    index.insert(index.begin(), window.innerIndex);
    index.push_back(window.outerIndex);
    std::vector<Point3d> points;
    for (size_t i = 0; i < pixels.size(); i++)
    {
        Vec3d at, direction = directions[i];
        double height = window.distance;        // of the next surface, along the normal
        for (size_t surface = 0; surface + 1 < index.size(); surface++)
        {
            const bool outermost = surface + 2 == index.size();
            const Vec3d normal = outermost ? normalize(window.normal + wedge.tilt) : window.normal;
            const Vec3d onAxis = (height + (outermost ? wedge.lift : 0.))*window.normal;
            at += direction*((onAxis - at).dot(normal)/direction.dot(normal));
            direction = refracted(direction, normal, index[surface], index[surface + 1]);
            if (!outermost)
                height += window.thickness[surface];
        }
        points.push_back(Point3d(at + direction*((z[i] - at[2])/direction[2])));
    }
    return points;
}

std::vector<Point2d> wedgeShift(const Ptr<RefractiveCamera>& camera, const std::vector<Point3d>& points, const Wedge& wedge)
{
    std::vector<Point2d> pixels;
    Mat jacobian;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels, noArray(), jacobian);
    std::vector<double> z;
    for (const Point3d& X : points)
        z.push_back(X.z);
    const std::vector<Point3d> traced = traceWedge(camera, pixels, wedge, z);
    std::vector<Point2d> shift;
    for (size_t i = 0; i < points.size(); i++)
    {
        // The pixel that looks at the point is the one whose ray does not miss it.
        const Vec3d miss = traced[i] - points[i];
        const auto row = [&](int r) { return Vec3d(jacobian.ptr<double>(2*(int)i + r) + 3).dot(miss); };
        shift.emplace_back(-row(0), -row(1));
    }
    return shift;
}

} // namespace tools
