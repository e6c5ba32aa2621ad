// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Starts of the windows. */

#include "start/window_start.hpp"
#include "start/coplanarity.hpp"
#include "start/normal_from_pairs.hpp"
#include "start/sealed_start.hpp"
#include "start/shared_window.hpp"
#include "start/start_table.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

namespace {

// The first search needs the rough shape of the cost only.
const int FEW_VIEWS = 8;
const size_t LIKELY_TILTS = 2;

//! As given, and at other distances if that is free.
std::vector<Rig> atAllDistances(const Rig& given, const RigViews& views, int flags)
{
    std::vector<Rig> rigs(1, given);
    if (flags & GLASS_FREE_DISTANCE)
        for (const Rig& other : atOtherDistances(given, views))
            rigs.push_back(other);
    return rigs;
}

//! The window as the rays' planes tilt it, at each distance; poses are found behind each.
std::vector<RigStart> coplanarTilts(const Rig& given, const RigViews& views, int flags)
{
    std::vector<RigStart> all;
    if (hasCenter(given.cameras[0].window().shape))
        return all;
    for (const Vec3d& normal : normalsByCoplanarity(given.cameras[0], views))
    {
        Rig tilted = given;
        WindowPlace place = placeOf(given.cameras[0].window());
        place.normal = normal;
        setPlace(tilted, 0, place);
        for (const Rig& rig : atAllDistances(tilted, views, flags))
            all.push_back({ rig, {} });
    }
    return all;
}

//! The given window, and the best few of the rings of tilts, all as they are: only the poses behind each are fitted.
std::vector<RigStart> likelyTilts(const Rig& rig, const RigViews& views)
{
    std::vector<RigStart> all, likely(1, { rig, {} });
    for (const TiltRing& ring : KNOWN_LENS_TILTS)
        for (const WindowPlace& place : placesAround(rig.cameras[0].window(), ring.tilt, ring.count, ring.first))
        {
            all.push_back({ rig, {} });
            setPlace(all.back().rig, 0, place);
        }
    for (const Minimum& best : multiStart(all, { { FEW_VIEWS, COARSE, LIKELY_TILTS } }, views, GLASS_FIX_NORMAL))
        likely.push_back(best);
    return likely;
}

/** The same window, where another pose of some target fits better: a flat target far away has two. Nothing where none does.*/
std::vector<RigStart> withBetterPoses(const Minimum& minimum, const RigViews& views)
{
    const double BETTER = 1e-3;
    const Camera& camera = minimum.rig.cameras[0];
    RigStart other = { minimum.rig, minimum.poses };
    bool isBetter = false;
    for (int view = 0; view < views.count(); view++)
    {
        const std::vector<Point2d>& pixels = views.cameras[0].refracted[view];
        double rms, before;
        const Pose pose = solvePose(camera, views.object[view], pixels, Pose(), rms);
        solvePose(camera, views.object[view], pixels, minimum.poses[view], before);
        if (!pose.found || !(rms < (1 - BETTER)*before))
            continue;
        other.poses[view] = pose;
        isBetter = true;
    }
    return std::vector<RigStart>(isBetter ? 1 : 0, other);
}

} // namespace

RigViews viewsThrough(const RigViews& views, int camera, std::vector<int>& which)
{
    RigViews all = { views.object, { views.cameras[camera] }, views.variance };
    all.cameras[0].directCovariances.clear();
    all.cameras[0].direct.assign(views.count(), std::vector<Point2d>());
    which.clear();
    for (int view = 0; view < views.count(); view++)
        if (countWhole(views.cameras[camera].refracted[view]) >= 4)
            which.push_back(view);
    return pick(all, which);
}

std::vector<Minimum> windowMinima(const Camera& camera, const RigViews& views, int flags)
{
    const Rig given = { { camera }, { 0 }, { Pose() } };
    std::vector<Stage> stages(1, { FEW_VIEWS, COARSE });
    if (views.count() > FEW_VIEWS)
        stages.push_back({ ALL_VIEWS, COARSE });
    if (flags & GLASS_FREE_DISTANCE)
    {
        Stage first = FIRST_OF_MANY;
        first.views = FEW_VIEWS;        // of which the poses are known
        stages.insert(stages.begin(), first);
    }
    flags &= GLASS_FREE_DISTANCE;
    std::vector<RigStart> starts;
    for (const Rig& rig : atAllDistances(given, views, flags))
        for (const RigStart& start : likelyTilts(rig, views))
            starts.push_back(start);
    for (const RigStart& start : coplanarTilts(given, views, flags))
        starts.push_back(start);
    const auto neighbours = [&](const Minimum& best)
    {
        std::vector<RigStart> others = mirrored(best.rig, given, flags);
        for (const RigStart& other : withBetterPoses(best, views))
            others.push_back(other);
        return others;
    };
    return hillClimb(multiStart(starts, stages, views, flags), neighbours, views, flags);
}

namespace {

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

//! With the normal and the poses that pairs tell, from several distances: from the camera on, a fit may not reach a far window.
std::vector<Minimum> distanceMinima(const Camera& camera, const RigViews& pairs, int flags)
{
    std::vector<RigStart> starts;
    for (const Rig& rig : atAllDistances({ { camera }, { 0 }, { Pose() } }, pairs, flags))
        starts.push_back({ rig, {} });
    return multiStart(starts, { { FEW_VIEWS, COARSE } }, pairs, flags & GLASS_FREE_DISTANCE);
}

/** Minima of a window that one camera's images through it tell, with poses that are known or not.
@param which the views
@param other the second best */
std::vector<Minimum> minimaSeenBy(const Rig& rig, int observer, const GlassWindow& window, const RigViews& views,
                                  const std::vector<Pose>& poses, bool areKnown, int flags, std::vector<int>& which, OtherMinimum& other)
{
    RigViews seen = viewsThrough(views, observer, which);
    if (which.empty() || !(window.normal[2] > 0 && distanceToSurface(window) >= 0))
        return {};
    const Camera camera = withWindow(rig.cameras[observer], window);
    if (areKnown)
    {
        const PixelViews direct = withPredicted(rig, observer, views, poses, flags);
        for (size_t i = 0; i < which.size(); i++)
            seen.cameras[0].direct[i] = direct[which[i]];
        return distanceMinima(camera, seen, flags);
    }
    std::vector<OtherMinimum> others(1);
    const std::vector<Minimum> minima = windowMinima(camera, seen, flags);
    describeOther(minima, others);
    other = others[0];
    return minima;
}

/** The window of one owner.
@param found what poses a search for it has found: of a window whose distance was not known, others would hide behind it */
GlassWindow startWindow(const Rig& rig, int owner, const RigViews& views, const std::vector<Pose>& poses, int flags,
                        OtherMinimum& other, std::vector<Pose>& found)
{
    GlassWindow window = rig.cameras[owner].window();
    if ((flags & GLASS_FIX_NORMAL) || !rig.cameras[owner].refracts())
        return window;
    // With poses known the centre of a dome has one minimum, which the fit reaches from the given place.
    const bool isRound = hasCenter(window.shape);
    const bool areKnown = isRound ? hasPairs(rig, owner, views, poses)
                                  : normalOfPairs(rig, owner, views, poses, flags, window.normal);
    const int best = bestObserver(rig, owner, views);
    const bool isSealed = (flags & GLASS_FREE_INTRINSICS) && best >= 0 && !seesAnything(views.cameras[best].direct);
    if (best < 0 || (areKnown ? isRound || !(flags & GLASS_FREE_DISTANCE) : isSealed))
        return window;
    std::vector<int> which;
    const Pose& ofOwner = rig.extrinsics[owner], ofBest = rig.extrinsics[best];
    const std::vector<Minimum> minima =
        minimaSeenBy(rig, best, transferred(window, ofOwner, ofBest), views, poses, areKnown, flags, which, other);
    if (minima.empty())
        return window;
    const Minimum& minimum = minima[0];
    const double givenDistance = window.distance;
    window = transferred(minimum.rig.cameras[0].window(), ofBest, ofOwner);
    if (!(flags & GLASS_FREE_DISTANCE))
        window.distance = givenDistance;
    for (size_t i = 0; i < which.size() && (flags & GLASS_FREE_DISTANCE); i++)
        if (i < minimum.poses.size() && minimum.poses[i].found && !found[which[i]].found)
            found[which[i]] = best == 0 ? minimum.poses[i] : inCamera1(minimum.poses[i], ofBest);
    other.window = transferred(other.window, ofBest, ofOwner);
    return window;
}

} // namespace

FitOutcome startWindows(Rig& rig, const RigViews& views, std::vector<Pose>& poses, int flags, std::vector<OtherMinimum>& others)
{
    others.assign(rig.count(), OtherMinimum());
    std::vector<Pose> found(views.count());
    for (int c = 0; c < rig.count(); c++)
        if (rig.owns(c))
            rig.cameras[c].setWindow(startWindow(rig, c, views, poses, flags, others[c], found));
    for (int view = 0; view < views.count(); view++)
        if (!poses[view].found)
            poses[view] = found[view];
    if (flags & GLASS_FREE_DISTANCE)
        giveToNearest(rig);
    return transferToOthers(rig);
}

FitOutcome keepGivenPlaces(const Rig& given, const RigViews& views, const std::vector<Pose>& poses, Rig& rig)
{
    for (int c = 0; c < rig.count(); c++)
        if (!showsWhatWasSeen(rig, c, views, poses))
            setPlace(rig, rig.owner[c], placeOf(given.cameras[rig.owner[c]].window()));
    return transferToOthers(rig);
}

}} // namespace
