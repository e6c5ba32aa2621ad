// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "start/sealed_start.hpp"
#include "adjust/minimize.hpp"

namespace cv { namespace refract {

namespace {

const int FEW_VIEWS = 6, MORE_VIEWS = 10;
const int BOTH = TermCriteria::COUNT + TermCriteria::EPS;
const TermCriteria FIRST_LOOK(BOTH, 20, 1e-8), SECOND_LOOK(BOTH, 100, 1e-8);
const size_t FINALISTS = 6;
const double PARTS_OF_RANGE[] = { 0.15, 0.4, 0.75 };
const double TILT = 0.25;       // radians
const int AZIMUTHS = 4;
const double ROUGHLY_SAME_ANGLE = 0.05, SAME_DISTANCE = 0.05;   // as SAME_ANGLE: before the end of a fit; part of the distance

//! So many of the views, evenly.
std::vector<int> someOf(const RigStart& start, int atMost)
{
    std::vector<int> found, some;
    for (int view = 0; view < (int)start.poses.size(); view++)
        if (start.poses[view].found)
            found.push_back(view);
    const int count = std::min(atMost, (int)found.size());
    for (int i = 0; i < count; i++)
        some.push_back(found[i*found.size()/count]);
    return some;
}

RigViews pick(const RigViews& views, const std::vector<int>& some)
{
    RigViews picked;
    picked.cameras.resize(views.cameras.size());
    for (int view : some)
    {
        picked.object.push_back(views.object[view]);
        for (size_t c = 0; c < views.cameras.size(); c++)
        {
            picked.cameras[c].direct.push_back(views.cameras[c].direct[view]);
            picked.cameras[c].refracted.push_back(views.cameras[c].refracted[view]);
        }
    }
    return picked;
}

//! Mean distance of the targets.
double rangeOf(const RigStart& start)
{
    double sum = 0;
    int count = 0;
    for (const Pose& pose : start.poses)
        if (pose.found)
        {
            sum += norm(pose.tvec);
            count++;
        }
    return sum/count;
}

/** A lens that was calibrated through the window as if there were none has taken up the medium beyond: its focal length is
longer by the ratio of the indices, its distortion and principal point say more of the window than of the lens. */
Rig withoutMedium(Rig rig, int flags)
{
    for (Camera& camera : rig.cameras)
    {
        const GlassWindow window = camera.window();
        const Size image = camera.imageSize();
        const std::vector<bool> isFree = freeLens(camera, flags);
        std::vector<double> lens = camera.lens().parameters();
        for (int i = 0; i < (int)lens.size(); i++)
            if (isFree[i] && i < 2)
                lens[i] *= window.innerIndex/window.outerIndex;
            else if (isFree[i] && i > 3)
                lens[i] = 0;
            else if (isFree[i] && !image.empty())
                lens[i] = 0.5*((i == 2 ? image.width : image.height) - 1);
        camera.setLensParameters(Mat(lens));
    }
    return rig;
}

//! The lenses as given and without the medium, each at several distances.
std::vector<Rig> untilted(const RigStart& given, int flags)
{
    std::vector<Rig> rigs(1, given.rig);
    if (!(flags & GLASS_FREE_DISTANCE))
        return rigs;
    rigs.push_back(withoutMedium(given.rig, flags));
    for (int lens = 0; lens < 2; lens++)
        for (double part : PARTS_OF_RANGE)
        {
            Rig rig = rigs[lens];
            if (setDistances(rig, part*rangeOf(given)))
                rigs.push_back(rig);
        }
    return rigs;
}

//! Each rig as it is, and with one of its windows tilted.
std::vector<Rig> tilted(const std::vector<Rig>& rigs, int owner)
{
    std::vector<Rig> all = rigs;
    for (const Rig& rig : rigs)
        for (int i = 0; i < AZIMUTHS; i++)
        {
            const double azimuth = (i + 0.5)*2*CV_PI/AZIMUTHS;
            Rig other = rig;
            if (setNormal(other, owner,
                          Vec3d(std::sin(TILT)*std::cos(azimuth), std::sin(TILT)*std::sin(azimuth), std::cos(TILT))))
                all.push_back(other);
        }
    return all;
}

Trial fitSome(const Rig& rig, const RigViews& views, const TermCriteria& criteria, int flags)
{
    RigStart start = { rig, std::vector<Pose>(views.count()) };
    addPosesThroughWindow(rig, views, start.poses);
    return fitFrom(start, views, criteria, flags);      // fails where a view has no pose
}

//! The best first; of two that end alike the first.
std::vector<Trial> fitEach(const std::vector<Rig>& starts, const RigViews& views, const TermCriteria& criteria, int flags)
{
    std::vector<Trial> trials;
    for (const Rig& start : starts)
        trials.push_back(fitSome(start, views, criteria, flags));
    std::stable_sort(trials.begin(), trials.end());
    return trials;
}

double angleOfNormals(const Rig& a, const Rig& b, int c)
{
    return angleBetween(a.cameras[c].layers().normal(), b.cameras[c].layers().normal());
}

bool isSameWindow(const Rig& a, const Rig& b, int c, double angle)
{
    const double distance = a.cameras[c].window().distance;
    return angleOfNormals(a, b, c) <= angle && std::abs(distance - b.cameras[c].window().distance) <= SAME_DISTANCE*distance;
}

bool isFirstBehind(const Rig& rig, int c)
{
    return std::find(rig.owner.begin(), rig.owner.end(), rig.owner[c]) == rig.owner.begin() + c;
}

bool areSame(const Rig& a, const Rig& b, double angle)
{
    for (int c = 0; c < a.count(); c++)
        if (!isSameWindow(a, b, c, angle))
            return false;
    return true;
}

//! Of those that end in one place the best.
std::vector<Trial> distinct(const std::vector<Trial>& sorted, double angle)
{
    std::vector<Trial> places;
    for (const Trial& trial : sorted)
        if (std::none_of(places.begin(), places.end(), [&](const Trial& p) { return areSame(p.rig, trial.rig, angle); }))
            places.push_back(trial);
    return places;
}

/** The starts, as they are, whose fits are the best so far, the best first; one of those that lead to one place, as all that
lead to the best of some views would leave no room for the best of all. */
std::vector<Rig> bestStarts(const std::vector<Rig>& starts, size_t atMost, const RigViews& views, const TermCriteria& criteria,
                            int flags)
{
    std::vector<Rig> best;
    for (const Trial& trial : distinct(fitEach(starts, views, criteria, flags), ROUGHLY_SAME_ANGLE))
        if (best.size() < atMost)
            best.push_back(trial.start);
    return best;
}

/** The same rig on the other side of what a tilt is exchanged for: a window tilted the other way, or, with the window as it is,
a lens with its principal point there and no distortion. One after the other; nothing where that is the same.
@param middle where principal points are looked for around */
std::vector<Rig> otherSides(const Rig& rig, const Rig& middle, int flags)
{
    std::vector<Rig> others;
    for (int c = 0; c < rig.count(); c++)
    {
        const Vec3d normal = rig.cameras[c].layers().normal();
        if (rig.owns(c) && std::hypot(normal[0], normal[1]) > ROUGHLY_SAME_ANGLE)
        {
            Rig other = rig;
            if (setNormal(other, c, Vec3d(-normal[0], -normal[1], normal[2])))
                others.push_back(other);
        }
        const std::vector<bool> isFree = freeLens(rig.cameras[c], flags);
        std::vector<double> lens = rig.cameras[c].lens().parameters();
        const std::vector<double> around = middle.cameras[c].lens().parameters();
        for (int i = 2; i < (int)lens.size(); i++)
            if (isFree[i])
                lens[i] = i < 4 ? 2*around[i] - lens[i] : 0;
        if (lens == rig.cameras[c].lens().parameters())
            continue;
        others.push_back(rig);
        others.back().cameras[c].setLensParameters(Mat(lens));
    }
    return others;
}

} // namespace

//! Whether every view of which something was seen has a pose.
static bool isPlaced(const RigViews& views, const std::vector<Pose>& poses)
{
    for (int view = 0; view < views.count(); view++)
        for (const CameraViews& camera : views.cameras)
            if (!poses[view].found && countSeen(camera.direct[view]) + countSeen(camera.refracted[view]) > 0)
                return false;
    return true;
}

Trial fitFrom(const RigStart& start, const RigViews& views, const TermCriteria& criteria, int flags)
{
    const Trial failure = { start.rig, start.rig, start.poses, std::numeric_limits<double>::infinity(), 0, false };
    if (!isPlaced(views, start.poses))
        return failure;
    Problem problem(start.rig, views, start.poses, std::vector<PosePrior>(), std::vector<CameraPrior>(), flags);
    const FitOutcome outcome = minimize(problem, criteria);
    if (!outcome.isUsable())
        return failure;
    Trial trial = { start.rig, problem.rig(), start.poses, problem.squaredError(), problem.freedom(), outcome.converged() };
    for (int view = 0; view < views.count(); view++)
        trial.poses[view] = problem.pose(view);
    return std::isfinite(trial.cost) ? trial : failure;     // it is sorted by
}

double excessOver(const Trial& best, const Trial& other) { return excessOf(other.cost, best.cost, best.freedom); }

std::vector<Trial> plausibleTrials(const std::vector<Trial>& sorted)
{
    std::vector<Trial> plausible;
    for (const Trial& trial : distinct(sorted, SAME_ANGLE))
        if (std::isfinite(trial.cost) && excessOver(sorted[0], trial) < PLAUSIBLE)
            plausible.push_back(trial);
    return plausible;
}

void describeOther(const std::vector<Trial>& sorted, std::vector<OtherMinimum>& others)
{
    for (const Trial& trial : sorted)
    {
        if (!trial.converged || areSame(sorted[0].rig, trial.rig, SAME_ANGLE))
            continue;
        for (int c = 0; c < trial.rig.count(); c++)
            if (isFirstBehind(trial.rig, c) && !isSameWindow(sorted[0].rig, trial.rig, c, SAME_ANGLE))
            {
                others[c].normal = trial.rig.cameras[c].layers().normal();
                others[c].distance = trial.rig.cameras[c].window().distance;
                others[c].excess = excessOver(sorted[0], trial);
            }
        return;
    }
}

bool RigTask::isSealed() const
{
    bool tellsMore = !knownPoses.empty();
    for (const CameraPrior& prior : cameraPriors)
        tellsMore = tellsMore || prior.covariance.size() > 0;
    for (const CameraViews& camera : views.cameras)
        tellsMore = tellsMore || seesAnything(camera.direct);
    return !tellsMore && (flags & GLASS_FREE_INTRINSICS);
}

bool RigTask::isIncremental() const
{
    return isSealed() && views.cameras.size() > 1 && (flags & GLASS_FREE_EXTRINSICS) && !isRobust();
}

void turnOver(const Rig& middle, std::vector<Trial>& sorted, const RigViews& views, const TermCriteria& criteria, int flags)
{
    const double BETTER = 1e-6;
    const int ROUNDS = 10;      // perfect data have ever smaller rounding errors
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < ROUNDS && sorted[0].cost < (1 - BETTER)*before; round++)
    {
        before = sorted[0].cost;
        for (const Rig& other : otherSides(sorted[0].rig, middle, flags))
            sorted.push_back(fitSome(other, views, criteria, flags));
        std::stable_sort(sorted.begin(), sorted.end());
    }
}

std::vector<Trial> sealedMinima(const RigStart& given, const RigViews& views, int flags)
{
    const RigViews few = pick(views, someOf(given, FEW_VIEWS)), more = pick(views, someOf(given, MORE_VIEWS));
    const RigViews all = pick(views, someOf(given, views.count()));
    std::vector<Rig> starts = untilted(given, flags);
    for (int owner = 0; owner < given.rig.count(); owner++)
        if (given.rig.owns(owner))
            starts = bestStarts(tilted(starts, owner), FINALISTS, few, FIRST_LOOK, flags);
    std::vector<Rig> plausible;
    for (const Trial& trial : plausibleTrials(fitEach(starts, more, SECOND_LOOK, flags)))
        plausible.push_back(trial.rig);
    // Some views may have their least cost in another minimum than all have.
    std::vector<Trial> minima = fitEach(plausible, all, TO_THE_END, flags);
    if (minima.empty() || !std::isfinite(minima[0].cost))
        return std::vector<Trial>();
    turnOver(given.rig, minima, all, TO_THE_END, flags);
    return minima;
}

RigStart bestSealedStart(const RigStart& given, const RigViews& views, int flags, std::vector<OtherMinimum>& others)
{
    const std::vector<Trial> minima = sealedMinima(given, views, flags);
    if (minima.empty())
        return given;
    describeOther(minima, others);
    RigStart start = { minima[0].rig, std::vector<Pose>(views.count()) };
    addPosesThroughWindow(start.rig, views, start.poses);
    for (int view = 0; view < views.count(); view++)
        if (!start.poses[view].found && given.poses[view].found)
            return given;
    return start;
}

}} // namespace
