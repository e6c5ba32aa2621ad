// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Windows of a rig: one camera owns each, the others see it from where they are. */

#include "start/shared_window.hpp"
#include "window/wedge.hpp"

namespace cv { namespace refract {

namespace {

//! The window of an owner as another camera sees it; the distance is negative beyond it.
GlassWindow seenFrom(const Rig& rig, int c)
{
    const TransformWithDerivatives a(rig.extrinsics[rig.owner[c]]), b(rig.extrinsics[c]);
    const Matx33d R = b.rotation.R*a.rotation.R.t();
    return windowInFrame(rig.cameras[rig.owner[c]].window(), R, b.T - R*a.T);
}

double distanceFrom(const Rig& rig, int c) { return seenFrom(rig, c).distance; }

} // namespace

GlassWindow transferred(GlassWindow window, const Pose& from, const Pose& to)
{
    if (from.rvec == to.rvec && from.tvec == to.tvec)       // given values stay to the last bit
        return window;
    const TransformWithDerivatives a(from), b(to);
    const Matx33d R = b.rotation.R*a.rotation.R.t();
    const std::vector<double> given = window.thickness;
    window = windowInFrame(window, R, b.T - R*a.T);
    // The fit refuses a window that is behind the camera, and faces that meet before it.
    window.distance = std::max(window.distance, 0.);
    for (size_t i = 0; i < given.size(); i++)
        window.thickness[i] = std::max(window.thickness[i], 1e-3*given[i]);
    return window;
}

FitOutcome transferToOthers(Rig& rig)
{
    for (int c = 0; c < rig.count(); c++)
    {
        if (rig.owns(c))
            continue;
        const GlassWindow window = transferred(rig.cameras[rig.owner[c]].window(), rig.extrinsics[rig.owner[c]], rig.extrinsics[c]);
        FitOutcome outcome(FitOutcome::LOOKS_AWAY);
        outcome.camera = c;
        outcome.point = Point3d(window.normal);
        outcome.distance = distanceToSurface(window);
        if (!(window.normal[2] > 0))
            return outcome;
        outcome.status = FitOutcome::BEYOND_WINDOW;
        if (hasCenter(window.shape) && !(outcome.distance > 0))
            return outcome;
        rig.cameras[c].setWindow(window);
    }
    return FitOutcome();
}

void giveToNearest(Rig& rig)
{
    const std::vector<int> given = rig.owner;
    for (int owner = 0; owner < rig.count(); owner++)
    {
        if (given[owner] != owner || hasCenter(rig.cameras[owner].window().shape))
            continue;
        int nearest = owner;
        for (int c = owner + 1; c < rig.count(); c++)
            if (given[c] == owner && seenFrom(rig, c).normal[2] > 0 && distanceFrom(rig, c) < distanceFrom(rig, nearest))
                nearest = c;
        if (nearest == owner)
            continue;
        const double least = distanceFrom(rig, nearest);
        GlassWindow window = rig.cameras[owner].window();
        if (least < 0)
            window.distance += window.distance - least;     // the nearest is where the first was thought to be
        rig.cameras[nearest].setWindow(transferred(window, rig.extrinsics[owner], rig.extrinsics[nearest]));
        for (int c = 0; c < rig.count(); c++)
            if (given[c] == owner)
                rig.owner[c] = nearest;
    }
}

bool setDistances(Rig& rig, double distance)
{
    for (int c = 0; c < rig.count(); c++)
    {
        GlassWindow window = rig.cameras[c].window();
        if (!rig.owns(c) || hasCenter(window.shape))
            continue;
        window.distance = distance;
        rig.cameras[c].setWindow(window);
    }
    return transferToOthers(rig).converged();
}

bool scaleDistances(Rig& rig, double factor)
{
    for (int c = 0; c < rig.count(); c++)
    {
        GlassWindow window = rig.cameras[c].window();
        if (!rig.owns(c) || hasCenter(window.shape))
            continue;
        window.distance *= factor;
        rig.cameras[c].setWindow(window);
    }
    return transferToOthers(rig).converged();
}

bool setPlace(Rig& rig, int owner, const WindowPlace& place)
{
    rig.cameras[owner].setWindow(withPlace(rig.cameras[owner].window(), place));
    return transferToOthers(rig).converged();
}

}} // namespace
