// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "sealed_start.hpp"
#include "rotation.hpp"

namespace cv { namespace refract {

namespace {

const int SEARCH_VIEWS = 10;
const double PARTS_OF_RANGE[] = { 0.15, 0.4, 0.75 };
const double TILT = 0.25;       // radians
const int AZIMUTHS = 4;

//! So many of the views, evenly.
std::vector<int> someOf(const RigStart& start)
{
    std::vector<int> found, some;
    for (int view = 0; view < (int)start.poses.size(); view++)
        if (start.poses[view].found)
            found.push_back(view);
    const int count = std::min(SEARCH_VIEWS, (int)found.size());
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

//! A start and what its fit leaves.
struct Trial
{
    RigStart fitted;
    double cost;
};

class Search
{
public:
    Search(const RigStart& given, const RigViews& views, const RigTask& task)
        : task_(task), some_(someOf(given)), views_(pick(views, some_))
    {
        best_.fitted = given;
        best_.cost = std::numeric_limits<double>::infinity();
        tryFrom(given.rig);
    }

    void tryDistances()
    {
        const RigStart first = best_.fitted;
        for (double part : PARTS_OF_RANGE)
        {
            Rig rig = first.rig;
            setDistances(rig, part*rangeOf(first));
            tryFrom(rig);
        }
    }

    void tryTilts()
    {
        for (int owner = 0; owner < best_.fitted.rig.count(); owner++)
        {
            if (!best_.fitted.rig.owns(owner))
                continue;
            const Rig first = best_.fitted.rig;
            for (int i = 0; i < AZIMUTHS; i++)
            {
                Rig rig = first;
                const double azimuth = (i + 0.5)*2*CV_PI/AZIMUTHS;
                setNormal(rig, owner, Vec3d(std::sin(TILT)*std::cos(azimuth), std::sin(TILT)*std::sin(azimuth), std::cos(TILT)));
                tryFrom(rig);
            }
        }
    }

    const Rig& best() const { return best_.fitted.rig; }

private:
    void tryFrom(const Rig& rig)
    {
        const TermCriteria rough(TermCriteria::COUNT + TermCriteria::EPS, 60, 1e-8);
        try
        {
            std::vector<Pose> poses(views_.count());
            addPosesThroughWindow(rig, views_, poses);
            checkPoses(views_, poses);
            RigProblem problem(rig, views_, poses, std::vector<PoseKnowledge>(), std::vector<CameraKnowledge>(), task_.flags);
            problem.solve(rough);
            const double cost = problem.squaredError();
            if (!(cost < best_.cost))
                return;
            best_.cost = cost;
            best_.fitted.rig = problem.rig();
            best_.fitted.poses.clear();
            for (int view = 0; view < views_.count(); view++)
                best_.fitted.poses.push_back(problem.pose(view));
        }
        catch (const cv::Exception&) {}     // from there a point has no image
    }

    const RigTask& task_;
    const std::vector<int> some_;
    const RigViews views_;
    Trial best_;
};

} // namespace

bool isSealed(const RigTask& task)
{
    bool tellsMore = !task.knownPoses.empty() || !task.cameras.empty();
    for (const CameraViews& camera : task.views.cameras)
        tellsMore = tellsMore || seesAnything(camera.direct);
    return !tellsMore && (task.flags & GLASS_FREE_INTRINSICS);
}

RigStart bestSealedStart(const RigStart& given, const RigViews& views, const RigTask& task)
{
    Search search(given, views, task);
    if (task.flags & GLASS_FREE_DISTANCE)
        search.tryDistances();
    search.tryTilts();
    RigStart start = { search.best(), std::vector<Pose>(views.count()) };
    addPosesThroughWindow(start.rig, views, start.poses);
    for (int view = 0; view < views.count(); view++)
        if (!start.poses[view].found && given.poses[view].found)
            return given;
    return start;
}

}} // namespace
