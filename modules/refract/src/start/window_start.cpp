// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Starts of the windows. */

#include "start/window_start.hpp"
#include "start/normal_from_pairs.hpp"
#include "start/shared_window.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

namespace {

// The first search needs the rough shape of the cost only.
const int FEW_VIEWS = 8;
const size_t LIKELY_TILTS = 4;

//! What the camera saw through the window.
RigViews viewsThrough(const RigViews& views, int camera)
{
    RigViews all = { views.object, { views.cameras[camera] }, views.variance };
    all.cameras[0].directCovariances.clear();
    all.cameras[0].direct.assign(views.count(), std::vector<Point2d>());
    std::vector<int> seen;
    for (int view = 0; view < views.count(); view++)
        if (countWhole(all.cameras[0].refracted[view]) >= 4)
            seen.push_back(view);
    return pick(all, seen);
}

//! The given window, and the best few of two rings of tilts, all as they are: only the poses behind each are fitted.
std::vector<RigStart> likelyTilts(const RigStart& given, const RigViews& views)
{
    const std::vector<Stage> look(1, { FEW_VIEWS, COARSE, LIKELY_TILTS });
    const Minimum placed = multiStart({ given }, look, views, GLASS_FIX_NORMAL)[0];
    const RigStart& first = std::isfinite(placed.cost) ? placed : given;    // poses behind one window are near those behind another
    std::vector<RigStart> ring, likely(1, first);
    for (double tilt : { 0., 0.2, 0.45 })
        for (const WindowPlace& place : placesAround(given.rig.cameras[0].window(), tilt, tilt > 0 ? 8 : 1, 0))
        {
            ring.push_back(first);
            setPlace(ring.back().rig, 0, place);
        }
    for (const Minimum& best : multiStart(ring, look, views, GLASS_FIX_NORMAL))
        likely.push_back(best);
    return likely;
}

//! The window of one camera from images through it alone.
GlassWindow searchWindow(const Camera& camera, const RigViews& views, int flags, OtherMinimum& other)
{
    if (views.count() == 0)
        return camera.window();
    const RigStart given = { { { camera }, { 0 }, { Pose() } }, std::vector<Pose>() };
    std::vector<Stage> stages(1, { FEW_VIEWS, COARSE });
    if (views.count() > FEW_VIEWS)
        stages.push_back({ ALL_VIEWS, COARSE });
    const std::vector<Minimum> minima = multiStart(likelyTilts(given, views), stages, views, flags & GLASS_FREE_DISTANCE);
    std::vector<OtherMinimum> others(1);
    describeOther(minima, others);
    other = others[0];
    return minima[0].rig.cameras[0].window();
}

/** What a camera would see without the window, where it has no direct image but the pose is known without. Not if R and T are free
and no direct image tells them: the normal would make up for their error. */
PixelViews withPredicted(const Rig& rig, int c, const RigViews& views, const std::vector<Pose>& poses, int flags)
{
    PixelViews direct = views.cameras[c].direct;
    if (c > 0 && (flags & GLASS_FREE_EXTRINSICS) && !seesAnything(direct))
        return direct;
    const TransformWithDerivatives toCamera(rig.extrinsics[c]);
    for (int view = 0; view < views.count(); view++)
    {
        if (!poses[view].found || !direct[view].empty())
            continue;
        const TransformWithDerivatives toCamera1(poses[view]);
        for (const Point3d& point : views.object[view])
        {
            const Vec3d X = toCamera.apply(toCamera1.apply(Vec3d(point)));
            Point2d pixel;
            uchar status = REFRACT_OK;
            rig.cameras[c].lens().project(1, &X[0], &X[1], &X[2], &pixel.x, &pixel.y, &status);
            const double missing = std::numeric_limits<double>::quiet_NaN();
            direct[view].push_back(status == REFRACT_OK ? pixel : Point2d(missing, missing));
        }
    }
    return direct;
}

//! Turns a direction from one camera's frame to another's.
Matx33d rotationBetween(const Rig& rig, int from, int to)
{
    return TransformWithDerivatives(rig.extrinsics[to]).rotation.R*TransformWithDerivatives(rig.extrinsics[from]).rotation.R.t();
}

//! The normal that the pairs of all cameras behind the window tell best, in the owner's frame; false if none does.
bool normalOfPairs(const Rig& rig, int owner, const RigViews& views, const std::vector<Pose>& poses, int flags,
                   Vec3d& normal)
{
    double least = std::numeric_limits<double>::infinity();
    for (int c = owner; c < rig.count(); c++)
    {
        if (rig.owner[c] != owner || !seesAnything(views.cameras[c].refracted))
            continue;
        const PixelViews direct = withPredicted(rig, c, views, poses, flags);
        const NormalEstimate estimate = (flags & GLASS_ROBUST ? normalFromInlierPairs : normalFromPairs)(
            rig.cameras[c], direct, views.cameras[c].refracted);
        if (!estimate.undetermined.empty() || !(estimate.normal[2] > 0))
            continue;
        const double variance = trace(estimate.covariance);     // NaN if two pairs leave no residual to scale it by
        const double rank = std::isnan(variance) ? DBL_MAX : variance;
        if (rank < least)
        {
            least = rank;
            normal = rotationBetween(rig, c, owner)*estimate.normal;
        }
    }
    return least < std::numeric_limits<double>::infinity();
}

//! Whether some view that was seen through the window has a pose without it.
bool hasPairs(const Rig& rig, int owner, const RigViews& views, const std::vector<Pose>& poses)
{
    for (int c = owner; c < rig.count(); c++)
        for (int view = 0; view < views.count() && rig.owner[c] == owner; view++)
            if (poses[view].found && countSeen(views.cameras[c].refracted[view]) > 0)
                return true;
    return false;
}

//! The camera that saw most through the window; -1 if none saw anything.
int bestObserver(const Rig& rig, int owner, const RigViews& views)
{
    int best = -1, most = 0;
    for (int c = owner; c < rig.count(); c++)
    {
        int seen = 0;
        for (const std::vector<Point2d>& pixels : views.cameras[c].refracted)
            seen += countWhole(pixels);
        if (rig.owner[c] != owner || seen <= most)
            continue;
        most = seen;
        best = c;
    }
    return best;
}

//! The window of one owner.
GlassWindow startWindow(const Rig& rig, int owner, const RigViews& views, const std::vector<Pose>& poses, int flags,
                        OtherMinimum& other)
{
    GlassWindow window = rig.cameras[owner].window();
    if ((flags & GLASS_FIX_NORMAL) || !rig.cameras[owner].refracts())
        return window;
    // With poses known the centre of a dome has one minimum, which the fit reaches from the given place.
    const bool areKnown = hasCenter(window.shape) ? hasPairs(rig, owner, views, poses)
                                                  : normalOfPairs(rig, owner, views, poses, flags, window.normal);
    if (areKnown || (flags & GLASS_FREE_INTRINSICS))
        return window;
    const int best = bestObserver(rig, owner, views);
    if (best < 0)
        return window;
    const GlassWindow seenByBest = transferred(window, rig.extrinsics[owner], rig.extrinsics[best]);
    if (!(seenByBest.normal[2] > 0 && distanceToSurface(seenByBest) >= 0))
        return window;
    const double givenDistance = window.distance;
    window = transferred(searchWindow(withWindow(rig.cameras[best], seenByBest), viewsThrough(views, best), flags, other),
                         rig.extrinsics[best], rig.extrinsics[owner]);
    if (!(flags & GLASS_FREE_DISTANCE))
        window.distance = givenDistance;
    other.window = transferred(other.window, rig.extrinsics[best], rig.extrinsics[owner]);
    return window;
}

} // namespace

FitOutcome startWindows(Rig& rig, const RigViews& views, const std::vector<Pose>& poses, int flags,
                        std::vector<OtherMinimum>& others)
{
    others.assign(rig.count(), OtherMinimum());
    for (int c = 0; c < rig.count(); c++)
        if (rig.owns(c))
            rig.cameras[c].setWindow(startWindow(rig, c, views, poses, flags, others[c]));
    if (flags & GLASS_FREE_DISTANCE)
        giveToNearest(rig);
    return transferToOthers(rig);
}

static bool showsWhatWasSeen(const Rig& rig, int c, const RigViews& views, const std::vector<Pose>& poses)
{
    const TransformWithDerivatives toCamera(rig.extrinsics[c]);
    for (int view = 0; view < views.count(); view++)
    {
        const std::vector<Point2d>& pixels = views.cameras[c].refracted[view];
        const TransformWithDerivatives toCamera1(poses[view]);
        for (size_t i = 0; i < pixels.size() && poses[view].found; i++)
        {
            const Vec3d X = toCamera.apply(toCamera1.apply(Vec3d(views.object[view][i])));
            double u, v;
            uchar status = REFRACT_OK;
            rig.cameras[c].project(1, &X[0], &X[1], &X[2], nullptr, &u, &v, &status);
            if (status != REFRACT_OK && isSeen(pixels[i]))
                return false;
        }
    }
    return true;
}

FitOutcome keepGivenPlaces(const Rig& given, const RigViews& views, const std::vector<Pose>& poses, Rig& rig)
{
    for (int c = 0; c < rig.count(); c++)
        if (!showsWhatWasSeen(rig, c, views, poses))
            setPlace(rig, rig.owner[c], placeOf(given.cameras[rig.owner[c]].window()));
    return transferToOthers(rig);
}

}} // namespace
