// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "start/sealed_start.hpp"
#include "start/rig_task.hpp"
#include "start/shared_window.hpp"
#include "start/start_table.hpp"

namespace cv { namespace refract {

namespace {

const Stage SECOND = { 10, COARSE, SIZE_MAX, SAME_ANGLE, PLAUSIBLE }, LAST = { ALL_VIEWS, FINE };

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
std::vector<RigStart> untilted(const RigStart& given, const RigViews& views, int flags)
{
    std::vector<RigStart> starts(1, { given.rig, {} });
    if (!(flags & GLASS_FREE_DISTANCE))
        return starts;
    starts.push_back({ withoutMedium(given.rig, flags), {} });
    for (int lens = 0; lens < 2; lens++)
        for (const Rig& rig : atOtherDistances(starts[lens].rig, views))
            starts.push_back({ rig, {} });
    return starts;
}

//! Each as it is, and with one of its windows tilted.
std::vector<RigStart> tilted(const std::vector<RigStart>& starts, int owner)
{
    std::vector<RigStart> all = starts;
    for (const RigStart& start : starts)
        for (const TiltRing& ring : SEALED_TILTS)
            for (const WindowPlace& place : placesAround(start.rig.cameras[owner].window(), ring.tilt, ring.count, ring.first))
            {
                RigStart other = start;
                if (setPlace(other.rig, owner, place))
                    all.push_back(other);
            }
    return all;
}

RigViews viewsWithPose(const RigViews& views, const std::vector<Pose>& poses)
{
    std::vector<int> placed;
    for (int view = 0; view < views.count(); view++)
        if (poses[view].found)
            placed.push_back(view);
    return pick(views, placed);
}

} // namespace

bool RigTask::isThroughWindowsOnly() const
{
    const bool knowsPose = std::any_of(knownPoses.begin(), knownPoses.end(), [](const Pose& pose) { return pose.found; });
    return !knowsPose && std::none_of(views.cameras.begin(), views.cameras.end(), [](const CameraViews& camera)
                                      { return seesAnything(camera.direct); });
}

//! Whether a covariance says something of these parameters; NaN: nothing is known.
static bool tells(const Eigen::MatrixXd& covariance, int first, int count)
{
    for (int i = first; i < std::min(first + count, (int)covariance.rows()); i++)
        if (!std::isnan(covariance(i, i)))
            return true;
    return false;
}

//! Of coefficients all may be known to be small, which is no start, and leaves a rig sealed.
static const int FOCAL_LENGTHS_AND_CENTRE = 4;

bool RigTask::isSealed(const Rig& rig) const
{
    bool tellsMore = false;
    for (size_t c = 0; c < cameraPriors.size(); c++)
    {
        const Eigen::MatrixXd& prior = cameraPriors[c].covariance;
        const int lens = rig.cameras[c].lensCount();
        tellsMore = tellsMore || tells(prior, 0, FOCAL_LENGTHS_AND_CENTRE) || tells(prior, lens, (int)prior.rows() - lens);
    }
    return isThroughWindowsOnly() && !tellsMore && (flags & GLASS_FREE_INTRINSICS);
}

int RigTask::searchFlags() const
{
    bool isLensKnown = !isThroughWindowsOnly();
    for (const CameraPrior& prior : cameraPriors)
        isLensKnown = isLensKnown || tells(prior.covariance, 0, FOCAL_LENGTHS_AND_CENTRE);
    return isLensKnown ? flags & ~GLASS_FREE_INTRINSICS : flags;
}

bool RigTask::isIncremental(const Rig& rig) const
{
    bool arePlacesKnown = !(flags & GLASS_FREE_EXTRINSICS);
    for (size_t c = 1; c < cameraPriors.size(); c++)
        arePlacesKnown = arePlacesKnown || tells(cameraPriors[c].covariance, rig.cameras[c].parameterCount(), 6);
    return isThroughWindowsOnly() && !arePlacesKnown && rig.count() > 1
           && (searchFlags() & (GLASS_FREE_INTRINSICS | GLASS_FREE_DISTANCE));
}

std::vector<RigStart> mirrored(const Rig& rig, const Rig& middle, int flags)
{
    std::vector<RigStart> others;
    for (int c = 0; c < rig.count(); c++)
    {
        const GlassWindow window = rig.cameras[c].window();
        for (const WindowPlace& place : mirroredPlaces(window))
        {
            RigStart other = { rig, {} };
            if (rig.owns(c) && angleBetweenPlaces(withPlace(window, place), window) > 2*ROUGHLY_SAME_ANGLE && setPlace(other.rig, c, place))
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
        others.push_back({ rig, {} });
        others.back().rig.cameras[c].setLensParameters(Mat(lens));
    }
    return others;
}

std::vector<Minimum> sealedMinima(const RigStart& given, const RigViews& views, int flags)
{
    const RigViews placed = viewsWithPose(views, given.poses);
    std::vector<RigStart> starts = untilted(given, placed, flags);
    for (int owner = 0; owner < given.rig.count(); owner++)
        if (given.rig.owns(owner))
        {
            const std::vector<Minimum> best = multiStart(tilted(starts, owner), { FIRST_OF_MANY }, placed, flags);
            starts.clear();
            for (const Minimum& minimum : best)
                starts.push_back(minimum.start);
        }
    const std::vector<Minimum> minima = multiStart(starts, { SECOND, LAST }, placed, flags);
    if (minima.empty() || !std::isfinite(minima[0].cost))
        return std::vector<Minimum>();
    return hillClimb(minima, [&](const Minimum& best) { return mirrored(best.rig, given.rig, flags); }, placed, flags);
}

RigStart bestSealedStart(const RigStart& given, const RigViews& views, int flags, std::vector<OtherMinimum>& others)
{
    const std::vector<Minimum> minima = sealedMinima(given, views, flags);
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
