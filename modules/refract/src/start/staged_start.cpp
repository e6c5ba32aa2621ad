// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Each camera alone, pairs, all: a camera alone has few parameters, of which many starts can be tried, and with a window of its
own and one view it is all that there is to find, as the places of the cameras follow from its pose. */

#include "start/staged_start.hpp"
#include "adjust/covariance.hpp"

namespace cv { namespace refract {

namespace {

const TermCriteria A_LOOK(TermCriteria::COUNT + TermCriteria::EPS, 100, 1e-8);
const int WALLS = 3;        // of so many cameras behind a window theirs is tried for all

//! One camera and the targets in its frame.
struct Seer
{
    Camera camera;
    std::vector<Pose> poses;
};

//! What a camera tells alone.
struct Alone
{
    std::vector<Seer> minima;       //!< the best first; at least one
    double distanceSigma;           //!< of the best, relative, for a pixel's of 1; infinite if it has none
};

//! What one camera saw well enough to have a pose, or what some did.
RigViews viewsOf(const RigViews& views, const std::vector<int>& cameras)
{
    RigViews picked;
    picked.object = views.object;
    for (int c : cameras)
    {
        picked.cameras.push_back(views.cameras[c]);
        for (std::vector<Point2d>& pixels : picked.cameras.back().refracted)
            if (countSeen(pixels) < 4)
                pixels.clear();
    }
    return picked;
}

bool refracts(const Camera& camera) { return camera.window().innerIndex != camera.window().outerIndex; }

double relativeDistanceSigma(const Seer& seer, const RigViews& views, int flags)
{
    const double infinity = std::numeric_limits<double>::infinity();
    const Rig rig = { { seer.camera }, { 0 }, { Pose() } };
    const Problem problem(rig, views, seer.poses, std::vector<PosePrior>(), std::vector<CameraPrior>(), flags);
    Covariance covariance;
    if (!problem.findPointWithoutImage().converged() || !covariance.compute(problem, 1, 0).converged())
        return infinity;        // nothing else is known of it
    const int row = seer.camera.lensCount() + seer.camera.layers().at().distance;
    return std::sqrt(covariance.ofParameters(row, row))/std::max(seer.camera.window().distance, DBL_MIN);
}

Seer seerOf(const Camera& camera, const RigViews& views)
{
    const Rig rig = { { camera }, { 0 }, { Pose() } };
    Seer seer = { camera, std::vector<Pose>(views.count()) };
    addPosesThroughWindow(rig, views, seer.poses);
    return seer;
}

Alone lookAlone(const Rig& given, int c, const RigViews& all, int flags)
{
    const RigViews views = viewsOf(all, { c });
    const Seer start = seerOf(given.cameras[c], views);
    const Rig rig = { { start.camera }, { 0 }, { Pose() } };
    RigStart from = { rig, start.poses };
    addPosesIgnoringWindow(rig, views, from.poses);
    if (!given.owns(c) && refracts(given.cameras[c]))
        flags |= GLASS_FREE_DISTANCE;       // what is given is that of another camera
    Alone alone = { std::vector<Seer>(), std::numeric_limits<double>::infinity() };
    const std::vector<Trial> minima = plausibleTrials(sealedMinima(from, views, flags));
    for (const Trial& minimum : minima)
        alone.minima.push_back(seerOf(minimum.rig.cameras[0], views));
    if (minima.empty())
        alone.minima.push_back(start);
    else
        alone.distanceSigma = relativeDistanceSigma(alone.minima[0], views, flags);
    return alone;
}

std::vector<Alone> lookAllAlone(const Rig& given, const RigViews& views, int flags)
{
    std::vector<Alone> alone(given.count());
    parallel_for_(Range(0, given.count()), [&](const Range& range)
    {
        for (int c = range.start; c < range.end; c++)
            alone[c] = lookAlone(given, c, views, flags);
    });
    return alone;
}

//! first -> second of a target's poses.
Pose between(const Pose& first, const Pose& second)
{
    const TransformWithDerivatives a(first), b(second);
    const Matx33d R = b.rotation.R*a.rotation.R.t();
    Pose pose;
    pose.rvec = rotationVector(R);
    pose.tvec = b.T - R*a.T;
    pose.found = true;
    return pose;
}

//! The pose in the frame of a camera at these extrinsics.
Pose inCamera(const Pose& inCamera1, const Pose& extrinsics)
{
    const TransformWithDerivatives E(extrinsics), X(inCamera1);
    Pose pose;
    pose.rvec = rotationVector(E.rotation.R*X.rotation.R);
    pose.tvec = E.apply(X.T);
    pose.found = inCamera1.found;
    return pose;
}

//! Sum of squared pixels of all views that the camera saw and that have a place, with the camera at these extrinsics.
double costAt(const Seer& seer, const Pose& extrinsics, const std::vector<Pose>& places, const CameraViews& seen,
              const std::vector<std::vector<Point3d> >& object)
{
    const double OUT_OF_SIGHT = 1e6;
    double cost = 0;
    for (size_t view = 0; view < places.size(); view++)
    {
        if (!places[view].found || !seer.poses[view].found)
            continue;
        const TransformWithDerivatives toCamera(inCamera(places[view], extrinsics));
        for (size_t i = 0; i < object[view].size(); i++)
        {
            const Point2d& pixel = seen.refracted[view][i];
            if (std::isnan(pixel.x))
                continue;
            const Vec3d X = toCamera.apply(Vec3d(object[view][i]));
            double u = 0, v = 0;
            uchar status = REFRACT_OK;
            seer.camera.project(1, &X[0], &X[1], &X[2], nullptr, &u, &v, &status);
            cost += status == REFRACT_OK ? std::min(norm(Point2d(u, v) - pixel), OUT_OF_SIGHT) : OUT_OF_SIGHT;
        }
    }
    return cost;
}

//! Where a camera is, by the view that tells it best for all that have a place; not found if it saw none of them.
Pose placeOf(const Seer& seer, const std::vector<Pose>& places, const CameraViews& seen,
             const std::vector<std::vector<Point3d> >& object)
{
    Pose best;
    double least = std::numeric_limits<double>::infinity();
    for (size_t view = 0; view < places.size(); view++)
    {
        if (!places[view].found || !seer.poses[view].found)
            continue;
        const Pose extrinsics = between(places[view], seer.poses[view]);
        const double cost = costAt(seer, extrinsics, places, seen, object);
        if (cost < least)
        {
            least = cost;
            best = extrinsics;
        }
    }
    return best;
}

//! Places the cameras one after the other, by views in common with those before; those without stay where they are.
void placeCameras(const std::vector<Seer>& seers, const RigViews& views, RigStart& start)
{
    std::vector<bool> isPlaced(seers.size(), false);
    start.poses = seers[0].poses;
    isPlaced[0] = true;
    for (bool changed = true; changed; )
    {
        changed = false;
        for (size_t c = 1; c < seers.size(); c++)
        {
            const Pose place = isPlaced[c] ? Pose() : placeOf(seers[c], start.poses, views.cameras[c], views.object);
            if (!place.found)
                continue;
            start.rig.extrinsics[c] = place;
            isPlaced[c] = changed = true;
            for (int view = 0; view < views.count(); view++)
                if (!start.poses[view].found && seers[c].poses[view].found)
                    start.poses[view] = inCamera1(seers[c].poses[view], place);
        }
    }
}

/** All cameras as they see the targets; behind a shared window that of one of them.
@param windowFrom per camera, whose window its owner gets
@return false if some camera looks away from its window then */
bool assemble(const Rig& given, const std::vector<Seer>& seers, const std::vector<int>& windowFrom, const RigViews& views,
              int flags, RigStart& start)
{
    start = { given, std::vector<Pose>() };
    placeCameras(seers, views, start);
    for (int c = 0; c < given.count(); c++)
        start.rig.cameras[c] = seers[c].camera;
    for (int c = 0; c < given.count(); c++)
    {
        const int from = windowFrom[c];
        if (!given.owns(c))
            continue;
        GlassWindow window = transferred(seers[from].camera.window(), start.rig.extrinsics[from], start.rig.extrinsics[c]);
        if (!(window.normal[2] > 0))
            return false;
        if (!(flags & GLASS_FREE_DISTANCE))
            window.distance = given.cameras[c].window().distance;
        start.rig.cameras[c].setWindow(window);
    }
    if (flags & GLASS_FREE_DISTANCE)
        giveToNearest(start.rig);
    return transferToOthers(start.rig).converged();
}

//! A failed trial where the start is impossible.
Trial fitAssembled(const Rig& given, const std::vector<Seer>& seers, const std::vector<int>& windowFrom, const RigViews& views,
                   const TermCriteria& criteria, int flags)
{
    RigStart start;
    if (assemble(given, seers, windowFrom, views, flags, start))
        return fitFrom(start, views, criteria, flags);
    return { given, given, std::vector<Pose>(), std::numeric_limits<double>::infinity(), 0, false };
}

//! The cameras of a fit, each with the targets in its own frame.
std::vector<Seer> seersOf(const Trial& trial, const std::vector<Seer>& before)
{
    std::vector<Seer> seers = before;
    for (int c = 0; c < trial.rig.count(); c++)
    {
        seers[c].camera = trial.rig.cameras[c];
        for (size_t view = 0; view < seers[c].poses.size(); view++)
            if (seers[c].poses[view].found)
                seers[c].poses[view] = inCamera(trial.poses[view], trial.rig.extrinsics[c]);
    }
    return seers;
}

//! The second of two cameras, fitted behind the window of the first.
Seer besideOther(const Rig& given, const std::vector<Seer>& seers, int first, int second, const RigViews& all, int flags)
{
    const Rig pair = { { given.cameras[first], given.cameras[second] }, { 0, 0 }, { Pose(), given.extrinsics[second] } };
    const std::vector<Seer> both = { seers[first], seers[second] };
    const RigViews views = viewsOf(all, { first, second });
    flags |= refracts(given.cameras[first]) ? GLASS_FREE_DISTANCE : 0;
    const Trial byFirst = fitAssembled(pair, both, { 0, 0 }, views, A_LOOK, flags);
    const Trial bySecond = fitAssembled(pair, both, { 1, 1 }, views, A_LOOK, flags);
    const Trial& best = bySecond < byFirst ? bySecond : byFirst;
    return std::isfinite(best.cost) ? seersOf(best, both)[1] : seers[second];
}

//! Cameras behind the window of one of them.
struct Wall
{
    int owner;
    std::vector<int> members;       //!< the one that tells most of it first
};

std::vector<Wall> wallsOf(const Rig& given, const std::vector<Alone>& alone)
{
    std::vector<Wall> walls;
    for (int owner = 0; owner < given.count(); owner++)
    {
        if (!given.owns(owner))
            continue;
        Wall wall = { owner, std::vector<int>() };
        for (int c = owner; c < given.count(); c++)
            if (given.owner[c] == owner)
                wall.members.push_back(c);
        std::stable_sort(wall.members.begin(), wall.members.end(), [&](int a, int b)
                         { return alone[a].distanceSigma < alone[b].distanceSigma; });
        walls.push_back(wall);
    }
    return walls;
}

//! All cameras behind the windows of those that tell so much of them: 0, the most.
Trial fitBehind(int rank, const Rig& given, const std::vector<Wall>& walls, const std::vector<Seer>& alone, const RigViews& views,
                int flags)
{
    std::vector<Seer> seers = alone;
    std::vector<int> windowFrom = given.owner;
    for (const Wall& wall : walls)
        for (int c : wall.members)
            windowFrom[c] = wall.members[std::min(rank, (int)wall.members.size() - 1)];
    parallel_for_(Range(0, given.count()), [&](const Range& range)
    {
        for (int c = range.start; c < range.end; c++)
            if (windowFrom[c] != c)
                seers[c] = besideOther(given, alone, windowFrom[c], c, views, flags);
    });
    return fitAssembled(given, seers, windowFrom, views, A_LOOK, flags);
}

//! Another camera that looks through the same window; -1: there is none.
int otherBehind(const Rig& given, int camera)
{
    for (int c = 0; c < given.count(); c++)
        if (c != camera && given.owner[c] == given.owner[camera])
            return c;
    return -1;
}

//! One camera after the other in its other minima, as long as that finds a better one.
void exchangeMinima(const Rig& given, const std::vector<Alone>& alone, std::vector<Trial>& sorted, const RigViews& views, int flags)
{
    const double BETTER = 1e-6;
    const int ROUNDS = 5;
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < ROUNDS && sorted[0].cost < (1 - BETTER)*before; round++)
    {
        before = sorted[0].cost;
        std::vector<Seer> best;
        for (const Alone& a : alone)
            best.push_back(a.minima[0]);
        best = seersOf(sorted[0], best);
        for (int c = 0; c < given.count(); c++)
            for (size_t i = 1; i < alone[c].minima.size(); i++)
            {
                std::vector<Seer> seers = best;
                seers[c] = alone[c].minima[i];
                std::vector<int> windowFrom = given.owner;
                const int other = otherBehind(given, c);
                if (other >= 0)
                {
                    seers[c] = besideOther(given, seers, other, c, views, flags);
                    windowFrom[given.owner[c]] = other;
                }
                sorted.push_back(fitAssembled(given, seers, windowFrom, views, TO_THE_END, flags));
            }
        std::stable_sort(sorted.begin(), sorted.end());
    }
}

} // namespace

RigStart stagedStart(const Rig& given, const RigViews& views, int flags, std::vector<OtherMinimum>& others)
{
    const std::vector<Alone> alone = lookAllAlone(given, views, flags);
    const std::vector<Wall> walls = wallsOf(given, alone);
    std::vector<Seer> best;
    for (const Alone& a : alone)
        best.push_back(a.minima[0]);
    size_t ranks = 1;
    for (const Wall& wall : walls)
        ranks = std::max(ranks, std::min(wall.members.size(), (size_t)WALLS));
    std::vector<Trial> trials;
    for (int rank = 0; rank < (int)ranks; rank++)
        trials.push_back(fitBehind(rank, given, walls, best, views, flags));
    std::stable_sort(trials.begin(), trials.end());
    std::vector<Trial> minima;
    for (const Trial& trial : plausibleTrials(trials))
        minima.push_back(fitFrom({ trial.rig, trial.poses }, views, TO_THE_END, flags));
    std::stable_sort(minima.begin(), minima.end());
    if (minima.empty() || !std::isfinite(minima[0].cost))
    {
        RigStart start;
        assemble(given, best, given.owner, views, flags, start);
        return start;
    }
    exchangeMinima(given, alone, minima, views, flags);
    if (given.count() == 2)
        turnOver(given, minima, views, TO_THE_END, flags);
    describeOther(minima, others);
    return { minima[0].rig, minima[0].poses };
}

}} // namespace
