// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "start/start_table.hpp"
#include "start/shared_window.hpp"

namespace cv { namespace refract {

namespace {

const double PARTS_OF_NEAREST[] = { 0.9, 0.7, 0.5, 0.25, 0.12 };

/** Distance of the nearest point from a camera that saw it, along the normal of its window, as if there were no windows; infinite if no
view has a pose. No window is farther: in the water behind it a target looks nearer than it is. */
double nearestDistance(const Rig& rig, const RigViews& views)
{
    std::vector<Pose> poses(views.count());
    addPosesIgnoringWindow(rig, views, poses);
    double nearest = std::numeric_limits<double>::infinity();
    for (int view = 0; view < views.count(); view++)
        for (int c = 0; c < rig.count() && poses[view].found; c++)
        {
            const std::vector<Point2d>& pixels = views.cameras[c].refracted[view];
            const Vec3d normal = rig.cameras[c].window().normal;
            const RigidTransform toCamera1 = transformOf(poses[view]), toCamera = transformOf(rig.extrinsics[c]);
            for (size_t i = 0; i < pixels.size(); i++)
                if (isSeen(pixels[i]))
                    nearest = std::min(nearest, normal.dot(toCamera.apply(toCamera1.apply(Vec3d(views.object[view][i])))));
        }
    return nearest;
}

} // namespace

std::vector<Rig> atOtherDistances(const Rig& rig, const RigViews& views)
{
    std::vector<Rig> rigs;
    bool haveDistance = false;
    for (int c = 0; c < rig.count(); c++)
        haveDistance = haveDistance || (rig.owns(c) && !hasCenter(rig.cameras[c].window().shape));
    const double nearest = haveDistance ? nearestDistance(rig, views) : std::numeric_limits<double>::infinity();
    for (double part : PARTS_OF_NEAREST)
    {
        Rig other = rig;
        if (std::isfinite(nearest) && nearest > 0 && setDistances(other, part*nearest))
            rigs.push_back(other);
    }
    return rigs;
}

}} // namespace
