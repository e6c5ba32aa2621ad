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

//! Points in images through the window that agree, each image's with a pose of its own.
int countInliers(const Camera& camera, const RigViews& views, const PixelViews& images)
{
    int count = 0;
    for (int view = 0; view < views.count(); view++)
    {
        std::vector<Point2d> pixels = images[view];
        keepInliers(camera, views.object[view], pixels);
        count += countSeen(pixels);
    }
    return count;
}

//! The camera behind that place of its window of which most points agree: as given, if nearly all do there.
Camera mostAgreeing(const Camera& given, const RigViews& views, int c)
{
    const double NEARLY_ALL = 0.9;
    const int ENOUGH = 3;           // images: the place is refined by all
    PixelViews images(views.count());
    int count = 0, seen = 0;
    for (int view = 0; view < views.count() && count < ENOUGH; view++)
    {
        images[view] = views.cameras[c].refracted[view];
        seen += countSeen(images[view]);
        count += !images[view].empty();
    }
    Camera best = given;
    int most = countInliers(given, views, images);
    for (const TiltRing& ring : KNOWN_LENS_TILTS)
        for (const WindowPlace& place : placesAround(given.window(), ring.tilt, ring.count, ring.first))
        {
            if (most >= NEARLY_ALL*seen)
                return best;
            const Camera other = withWindow(given, withPlace(given.window(), place));
            const int agree = countInliers(other, views, images);
            if (agree > most)
            {
                most = agree;
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
    }
    return inliers;
}

}} // namespace
