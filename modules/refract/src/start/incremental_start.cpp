// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Each camera alone, pairs, all: a camera alone has few parameters, of which many starts can be tried, and with a window of its
own and one view it is all that there is to find, as the places of the cameras follow from its pose. */

#include "start/incremental_start.hpp"
#include "adjust/covariance.hpp"
#include "start/rig_assembly.hpp"
#include "start/sealed_start.hpp"
#include "start/window_start.hpp"

namespace cv { namespace refract {

namespace {

const Stage ANY_PLAUSIBLE = { ALL_VIEWS, COARSE, SIZE_MAX, SAME_ANGLE, PLAUSIBLE }, LAST = { ALL_VIEWS, FINE };
const Stage FIRST_OF_PAIR = { 10, COARSE, 1 };      // where the second is; the fit of all follows
const size_t MAX_SOURCES = 3;       // of so many cameras behind a window theirs is tried for all

//! What a camera tells alone.
struct CameraMinima
{
    std::vector<CameraHypothesis> minima;   //!< the best first; at least one
    double distanceSigma;                   //!< of the best, relative, for a pixel's of 1; infinite if it has none
};

//! What one camera saw well enough to have a pose, or what some did.
RigViews viewsOf(const RigViews& views, const std::vector<int>& cameras)
{
    RigViews picked;
    picked.object = views.object;
    picked.variance = views.variance;
    for (int c : cameras)
    {
        picked.cameras.push_back(views.cameras[c]);
        for (std::vector<Point2d>& pixels : picked.cameras.back().refracted)
            if (countWhole(pixels) < 4)
                pixels.clear();
    }
    return picked;
}

bool refracts(const Camera& camera) { return camera.window().innerIndex != camera.window().outerIndex; }

double relativeDistanceSigma(const CameraHypothesis& hypothesis, const RigViews& views, int flags)
{
    const double infinity = std::numeric_limits<double>::infinity();
    const Rig rig = { { hypothesis.camera }, { 0 }, { Pose() } };
    const Problem problem(rig, views, hypothesis.poses, std::vector<PosePrior>(), std::vector<CameraPrior>(), flags);
    Covariance covariance;
    if (!problem.findPointWithoutImage().converged() || !covariance.compute(problem, 1, 0).converged())
        return infinity;        // nothing else is known of it
    const int row = hypothesis.camera.lensCount() + hypothesis.camera.layers().at().distance;
    return std::sqrt(covariance.ofParameters(row, row))/std::max(hypothesis.camera.window().distance, DBL_MIN);
}

CameraHypothesis placedCamera(const Camera& camera, const RigViews& views, int flags)
{
    Rig rig = { { camera }, { 0 }, { Pose() } };
    std::vector<Pose> poses(views.count());
    placeTargets(rig, views, flags, poses);
    return { rig.cameras[0], poses };
}

//! What the camera may be, the best first.
std::vector<Minimum> minimaAlone(const RigStart& start, const RigViews& views, int flags)
{
    if (flags & GLASS_FREE_INTRINSICS)
        return sealedMinima(start, views, flags);
    std::vector<int> which;
    const RigViews seen = viewsThrough(views, 0, which);
    return which.empty() ? std::vector<Minimum>() : windowMinima(start.rig.cameras[0], seen, flags);
}

CameraMinima fitSingleCamera(const Rig& given, int c, const RigViews& all, int flags)
{
    const RigViews views = viewsOf(all, { c });
    const CameraHypothesis start = placedCamera(given.cameras[c], views, 0);
    const Rig rig = { { start.camera }, { 0 }, { Pose() } };
    RigStart from = { rig, start.poses };
    addPosesIgnoringWindow(rig, views, from.poses);
    if (!given.owns(c) && refracts(given.cameras[c]))
        flags |= GLASS_FREE_DISTANCE;       // what is given is that of another camera
    CameraMinima alone = { std::vector<CameraHypothesis>(), std::numeric_limits<double>::infinity() };
    const std::vector<Minimum> minima = keptMinima(minimaAlone(from, views, flags), ANY_PLAUSIBLE);
    for (const Minimum& minimum : minima)
        alone.minima.push_back(placedCamera(minimum.rig.cameras[0], views, flags));
    if (minima.empty())
        alone.minima.push_back(start);
    else
        alone.distanceSigma = relativeDistanceSigma(alone.minima[0], views, flags);
    return alone;
}

std::vector<CameraMinima> fitSingleCameras(const Rig& given, const RigViews& views, int flags)
{
    std::vector<CameraMinima> alone(given.count());
    parallel_for_(Range(0, given.count()), [&](const Range& range)
    {
        for (int c = range.start; c < range.end; c++)
            alone[c] = fitSingleCamera(given, c, views, flags);
    });
    return alone;
}

std::vector<CameraHypothesis> bestOfEach(const std::vector<CameraMinima>& alone)
{
    std::vector<CameraHypothesis> best;
    for (const CameraMinima& camera : alone)
        best.push_back(camera.minima[0]);
    return best;
}

//! Nothing where some camera would look away from its window.
void addAssembled(const Rig& given, const std::vector<CameraHypothesis>& cameras, const std::vector<int>& windowFrom,
                  const RigViews& views, int flags, std::vector<RigStart>& starts)
{
    RigStart start;
    if (assemble(given, cameras, windowFrom, views, flags, start))
        starts.push_back(start);
}

//! Views that both cameras saw well enough.
std::vector<int> commonViews(const RigViews& views)
{
    std::vector<int> common;
    for (int view = 0; view < views.count(); view++)
        if (!views.cameras[0].refracted[view].empty() && !views.cameras[1].refracted[view].empty())
            common.push_back(view);
    return common;
}

//! The second of two cameras, fitted behind the window of the first.
CameraHypothesis fitPairBehindWindow(const Rig& given, const std::vector<CameraHypothesis>& cameras, int first, int second,
                                     const RigViews& all, int flags)
{
    const Rig pair = { { given.cameras[first], given.cameras[second] }, { 0, 0 }, { Pose(), given.extrinsics[second] } };
    const RigViews views = viewsOf(all, { first, second });
    const std::vector<int> common = commonViews(views);
    if (common.empty())
        return cameras[second];
    const RigViews both = pick(views, common);
    std::vector<CameraHypothesis> alone = { { cameras[first].camera, {} }, { cameras[second].camera, {} } };
    for (int view : common)
    {
        alone[0].poses.push_back(cameras[first].poses[view]);
        alone[1].poses.push_back(cameras[second].poses[view]);
    }
    flags |= refracts(given.cameras[first]) ? GLASS_FREE_DISTANCE : 0;
    std::vector<RigStart> starts;
    for (int from : { 0, 1 })
        addAssembled(pair, alone, { from, from }, both, flags, starts);
    const std::vector<Minimum> minima = multiStart(starts, { FIRST_OF_PAIR }, both, flags);
    return minima.empty() ? cameras[second] : placedCamera(camerasOf(minima[0], alone)[1].camera, viewsOf(all, { second }), 0);
}

//! Cameras behind the window of one of them.
struct SharedWindow
{
    std::vector<int> members;       //!< the one that tells most of it first
};

std::vector<SharedWindow> sharedWindowsOf(const Rig& given, const std::vector<CameraMinima>& alone)
{
    std::vector<SharedWindow> windows;
    for (int owner = 0; owner < given.count(); owner++)
    {
        if (!given.owns(owner))
            continue;
        SharedWindow window;
        for (int c = owner; c < given.count(); c++)
            if (given.owner[c] == owner)
                window.members.push_back(c);
        std::stable_sort(window.members.begin(), window.members.end(), [&](int a, int b)
                         { return alone[a].distanceSigma < alone[b].distanceSigma; });
        windows.push_back(window);
    }
    return windows;
}

//! All cameras behind the windows of those that tell so much of them: 0, the most.
void addBehind(size_t rank, const Rig& given, const std::vector<SharedWindow>& windows, const std::vector<CameraHypothesis>& alone,
               const RigViews& views, int flags, std::vector<RigStart>& starts)
{
    std::vector<CameraHypothesis> cameras = alone;
    std::vector<int> windowFrom = given.owner;
    for (const SharedWindow& window : windows)
        for (int c : window.members)
            windowFrom[c] = window.members[std::min(rank, window.members.size() - 1)];
    parallel_for_(Range(0, given.count()), [&](const Range& range)
    {
        for (int c = range.start; c < range.end; c++)
            if (windowFrom[c] != c)
                cameras[c] = fitPairBehindWindow(given, alone, windowFrom[c], c, views, flags);
    });
    addAssembled(given, cameras, windowFrom, views, flags, starts);
}

/** Whether those that tell so much of the windows alone have these where a fit of all has them: behind theirs all would come to the same.
A camera that is the only one behind its window has no other. */
bool isSeenAlone(size_t rank, const Minimum& minimum, const std::vector<SharedWindow>& windows, const std::vector<CameraMinima>& alone)
{
    const double range = meanRange(minimum.poses);
    return minimum.converged && std::all_of(windows.begin(), windows.end(), [&](const SharedWindow& window)
    {
        const int c = window.members[std::min(rank, window.members.size() - 1)];
        return rank >= window.members.size() ||
               isSameWindow(minimum.rig.cameras[c].window(), alone[c].minima[0].camera.window(), range, SAME_ANGLE);
    });
}

//! All cameras as they are alone, behind the window of one of those that tell most of it.
std::vector<Minimum> assembledMinima(const Rig& given, const std::vector<CameraMinima>& alone, const RigViews& views, int flags)
{
    const std::vector<SharedWindow> windows = sharedWindowsOf(given, alone);
    size_t sources = 1;
    for (const SharedWindow& window : windows)
        sources = std::max(sources, std::min(window.members.size(), MAX_SOURCES));
    std::vector<RigStart> starts;
    addBehind(0, given, windows, bestOfEach(alone), views, flags, starts);
    const std::vector<Minimum> first = multiStart(starts, { ANY_PLAUSIBLE }, views, flags);
    starts.assign(first.begin(), first.end());
    for (size_t rank = 1; rank < sources; rank++)
        if (first.empty() || !isSeenAlone(rank, first[0], windows, alone))
            addBehind(rank, given, windows, bestOfEach(alone), views, flags, starts);
    return multiStart(starts, starts.size() == first.size() ? std::vector<Stage>{ LAST } : std::vector<Stage>{ ANY_PLAUSIBLE, LAST },
                      views, flags);
}

//! Of the other cameras that look through the same window the one that tells most of it; -1: there is none.
int otherBehind(const Rig& given, const std::vector<CameraMinima>& alone, int camera)
{
    int best = -1;
    for (int c = 0; c < given.count(); c++)
        if (c != camera && given.owner[c] == given.owner[camera] && (best < 0 || alone[c].distanceSigma < alone[best].distanceSigma))
            best = c;
    return best;
}

//! The rig with one camera after the other in its other minima.
std::vector<RigStart> swapped(const Minimum& best, const Rig& given, const std::vector<CameraMinima>& alone, const RigViews& views,
                              int flags)
{
    const std::vector<CameraHypothesis> cameras = camerasOf(best, bestOfEach(alone));
    std::vector<RigStart> starts;
    for (int c = 0; c < given.count(); c++)
        for (size_t i = 1; i < alone[c].minima.size(); i++)
        {
            std::vector<CameraHypothesis> others = cameras;
            others[c] = alone[c].minima[i];
            std::vector<int> windowFrom = given.owner;
            const int other = otherBehind(given, alone, c);
            if (other >= 0)
            {
                others[c] = fitPairBehindWindow(given, others, other, c, views, flags);
                windowFrom[given.owner[c]] = other;
            }
            addAssembled(given, others, windowFrom, views, flags, starts);
        }
    return starts;
}

} // namespace

RigStart incrementalStart(const Rig& given, const RigViews& views, int flags, std::vector<OtherMinimum>& others)
{
    const std::vector<CameraMinima> alone = fitSingleCameras(given, views, flags);
    std::vector<Minimum> minima = assembledMinima(given, alone, views, flags);
    if (minima.empty() || !std::isfinite(minima[0].cost))
    {
        RigStart start;
        assemble(given, bestOfEach(alone), given.owner, views, flags, start);
        return start;
    }
    minima = hillClimb(minima, [&](const Minimum& best) { return swapped(best, given, alone, views, flags); }, views, flags);
    if (given.count() == 2)
        minima = hillClimb(minima, [&](const Minimum& best) { return mirrored(best.rig, given, flags); }, views, flags);
    describeOther(minima, others);
    return minima[0];
}

}} // namespace
