// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/sealed_start.hpp"

namespace cv { namespace refract {

namespace {

const int FEW_VIEWS = 6, MORE_VIEWS = 10;
const int FEW_ITERATIONS = 20, MORE_ITERATIONS = 100;
const size_t FINALISTS = 6;
const double PARTS_OF_RANGE[] = { 0.15, 0.4, 0.75 };
const double TILT = 0.25;       // radians
const int AZIMUTHS = 4;

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
            rigs.push_back(rigs[lens]);
            setDistances(rigs.back(), part*rangeOf(given));
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
            all.push_back(rig);
            setNormal(all.back(), owner,
                      Vec3d(std::sin(TILT)*std::cos(azimuth), std::sin(TILT)*std::sin(azimuth), std::cos(TILT)));
        }
    return all;
}

//! What a fit of so many iterations leaves of some views; infinite where a point has no image. rig is start and result.
double fitSome(Rig& rig, const RigViews& views, int iterations, int flags)
{
    try
    {
        std::vector<Pose> poses(views.count());
        addPosesThroughWindow(rig, views, poses);
        checkPoses(views, poses);
        RigProblem problem(rig, views, poses, std::vector<PoseKnowledge>(), std::vector<CameraKnowledge>(), flags);
        problem.solve(TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, iterations, 1e-8));
        rig = problem.rig();
        const double cost = problem.squaredError();
        return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();     // it is sorted by
    }
    catch (const cv::Exception&)
    {
        return std::numeric_limits<double>::infinity();
    }
}

//! The starts, as they are, whose fits are the best after so many iterations; the best first.
std::vector<Rig> bestStarts(const std::vector<Rig>& starts, size_t atMost, const RigViews& views, int iterations, int flags)
{
    std::vector<std::pair<double, size_t> > costs;
    for (size_t i = 0; i < starts.size(); i++)
    {
        Rig rig = starts[i];
        costs.push_back(std::make_pair(fitSome(rig, views, iterations, flags), i));
    }
    std::sort(costs.begin(), costs.end());
    std::vector<Rig> best;
    for (size_t i = 0; i < std::min(atMost, costs.size()); i++)
        best.push_back(starts[costs[i].second]);
    return best;
}

} // namespace

bool isSealed(const RigTask& task)
{
    bool tellsMore = !task.knownPoses.empty();
    for (const CameraKnowledge& known : task.cameras)
        tellsMore = tellsMore || known.covariance.size() > 0;
    for (const CameraViews& camera : task.views.cameras)
        tellsMore = tellsMore || seesAnything(camera.direct);
    return !tellsMore && (task.flags & GLASS_FREE_INTRINSICS);
}

RigStart bestSealedStart(const RigStart& given, const RigViews& views, const RigTask& task)
{
    const RigViews few = pick(views, someOf(given, FEW_VIEWS)), more = pick(views, someOf(given, MORE_VIEWS));
    std::vector<Rig> starts = untilted(given, task.flags);
    for (int owner = 0; owner < given.rig.count(); owner++)
        if (given.rig.owns(owner))
            starts = bestStarts(tilted(starts, owner), FINALISTS, few, FEW_ITERATIONS, task.flags);
    Rig best = bestStarts(starts, 1, more, MORE_ITERATIONS, task.flags)[0];
    fitSome(best, more, MORE_ITERATIONS, task.flags);
    RigStart start = { best, std::vector<Pose>(views.count()) };
    addPosesThroughWindow(start.rig, views, start.poses);
    for (int view = 0; view < views.count(); view++)
        if (!start.poses[view].found && given.poses[view].found)
            return given;
    return start;
}

}} // namespace
