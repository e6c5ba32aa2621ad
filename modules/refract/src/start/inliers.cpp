// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "start/inliers.hpp"
#include "start/start_table.hpp"

namespace cv { namespace refract {

namespace {

void keepInliers(const Camera& camera, const std::vector<Point3d>& object, std::vector<Point2d>& pixels)
{
    if (2*countWhole(pixels) >= countSeen(pixels))      // halves have no rays to sample: they stay
        pixels = pointsOfOnePose(camera, object, pixels);
}

//! Of some images through the window, each with a pose of its own.
double costOfPoses(const Camera& camera, const RigViews& views, int c)
{
    const int ENOUGH = 3;           // images: the window is refined by all
    double cost = 0;
    for (int view = 0, count = 0; view < views.count() && count < ENOUGH; view++)
        if (countWhole(views.cameras[c].refracted[view]) >= 4)
        {
            cost += costOfOnePose(camera, views.object[view], views.cameras[c].refracted[view]);
            count++;
        }
    return cost;
}

//! The camera behind that of several places of its window which most points agree with.
Camera mostAgreeing(const Camera& given, const RigViews& views, int c)
{
    Camera best = given;
    double least = costOfPoses(given, views, c);
    std::vector<TiltRing> rings(std::begin(KNOWN_LENS_TILTS), std::end(KNOWN_LENS_TILTS));
    rings.push_back(STEEP_TILTS);
    for (const TiltRing& ring : rings)
        for (const WindowPlace& place : placesAround(given.window(), ring.tilt, ring.count, ring.first))
        {
            const Camera other = withWindow(given, withPlace(given.window(), place));
            const double cost = costOfPoses(other, views, c);
            if (cost < least)
            {
                least = cost;
                best = other;
            }
        }
    return best;
}

} // namespace

RigViews inlierViews(const Rig& rig, const RigViews& views, int flags)
{
    RigViews inliers = views;
    for (int c = 0; c < rig.count(); c++)
    {
        const Camera& given = rig.cameras[c];
        const Camera bare = withWindow(given);
        const Camera glazed = (flags & GLASS_FIX_NORMAL) || !given.refracts() ? given : mostAgreeing(given, views, c);
        CameraViews& seen = inliers.cameras[c];
        for (int view = 0; view < views.count(); view++)
        {
            keepInliers(bare, views.object[view], seen.direct[view]);
            keepInliers(glazed, views.object[view], seen.refracted[view]);
        }
        if (!seesAnything(seen.refracted))      // the window is wrong, not all points
            seen.refracted = views.cameras[c].refracted;
    }
    return inliers;
}

}} // namespace
