// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/wedge.hpp"
#include "calibrate/rig_model.hpp"

using namespace cv;
using namespace cv::refract;

namespace tools {

GlassWindow withWedge(GlassWindow window, const Wedge& wedge)
{
    const Vec3d n = window.normal, e1 = normalize(Vec3d(1., 0., 0.) - n[0]*n), e2 = n.cross(e1);
    window.wedge.resize(window.thickness.size());
    window.wedge.back() += Vec2d(e1.dot(wedge.tilt), e2.dot(wedge.tilt));
    window.thickness.back() += wedge.lift;
    return window;
}

std::vector<Point2d> wedgeShift(const Ptr<RefractiveCamera>& camera, const std::vector<Point3d>& points, const Wedge& wedge)
{
    std::vector<Point2d> pixels, shift;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels);
    refractiveProjectPoints(points, Vec3d(), Vec3d(), copyWithWindow(camera, withWedge(camera->window(), wedge)), shift);
    for (size_t i = 0; i < points.size(); i++)
        shift[i] -= pixels[i];
    return shift;
}

} // namespace tools
