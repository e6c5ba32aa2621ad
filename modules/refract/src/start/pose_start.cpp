// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Starts of the views' poses. */

#include "start/pose_start.hpp"
#include "start/shared_window.hpp"

namespace cv { namespace refract {

namespace {

struct PoseSource
{
    int camera, count;
    bool operator<(const PoseSource& other) const { return count > other.count; }
};

//! The images of one view from which a pose can be had, the best first.
std::vector<PoseSource> poseSources(const RigViews& views, int view, bool direct)
{
    std::vector<PoseSource> sources;
    for (int c = 0; c < (int)views.cameras.size(); c++)
    {
        const PixelViews& pixels = direct ? views.cameras[c].direct : views.cameras[c].refracted;
        const PoseSource source = { c, countWhole(pixels[view]) };
        if (source.count >= 4)
            sources.push_back(source);
    }
    std::stable_sort(sources.begin(), sources.end());
    return sources;
}

Pose poseOfView(const std::vector<Camera>& cameras, const Rig& rig, const RigViews& views, int view, bool direct)
{
    for (const PoseSource& source : poseSources(views, view, direct))
    {
        const CameraViews& seen = views.cameras[source.camera];
        double rms;
        const Pose pose = solvePose(cameras[source.camera], views.object[view], (direct ? seen.direct : seen.refracted)[view],
                                    Pose(), rms);
        if (pose.found)
            return source.camera == 0 ? pose : inCamera1(pose, rig.extrinsics[source.camera]);
    }
    return Pose();
}

} // namespace

static std::vector<Camera> withoutWindows(const Rig& rig)
{
    std::vector<Camera> bare;
    for (const Camera& camera : rig.cameras)
        bare.push_back(withWindow(camera));
    return bare;
}

std::vector<Pose> posesWithoutWindow(const Rig& rig, const RigViews& views, const std::vector<Pose>& known)
{
    const std::vector<Camera> bare = withoutWindows(rig);
    std::vector<Pose> poses = known;
    poses.resize(views.count());
    for (int view = 0; view < views.count(); view++)
        if (!poses[view].found)
            poses[view] = poseOfView(bare, rig, views, view, true);
    return poses;
}

void addPosesThroughWindow(const Rig& rig, const RigViews& views, std::vector<Pose>& poses)
{
    for (int view = 0; view < views.count(); view++)
        if (!poses[view].found)
            poses[view] = poseOfView(rig.cameras, rig, views, view, false);
}

void addPosesIgnoringWindow(const Rig& rig, const RigViews& views, std::vector<Pose>& poses)
{
    const std::vector<Camera> bare = withoutWindows(rig);
    for (int view = 0; view < views.count(); view++)
        if (!poses[view].found)
            poses[view] = poseOfView(bare, rig, views, view, false);
}

bool showsWhatWasSeen(const Rig& rig, int c, const RigViews& views, const std::vector<Pose>& poses)
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

bool placeTargets(Rig& rig, const RigViews& views, int flags, std::vector<Pose>& poses)
{
    const std::vector<Pose> given = poses;
    for (double part : { 1., 0.97, 0.9, 0.75, 0.5, 0.25 })
    {
        Rig nearer = rig;
        if (part < 1 && !((flags & GLASS_FREE_DISTANCE) && scaleDistances(nearer, part)))
            break;
        std::vector<Pose> placed = given;
        addPosesThroughWindow(nearer, views, placed);
        bool areSeen = true;
        for (int view = 0; view < views.count(); view++)
            areSeen = areSeen && (placed[view].found || poseSources(views, view, false).empty());
        for (int c = 0; c < rig.count(); c++)
            areSeen = areSeen && showsWhatWasSeen(nearer, c, views, placed);
        if (part == 1)
            poses = placed;
        if (!areSeen)
            continue;
        rig = nearer;
        poses = placed;
        return true;
    }
    return false;
}

bool hasPoints(const RigViews& views, int view)
{
    return std::any_of(views.cameras.begin(), views.cameras.end(), [=](const CameraViews& camera)
                       { return countSeen(camera.direct[view]) + countSeen(camera.refracted[view]) > 0; });
}

FitOutcome checkPoses(const RigViews& views, const std::vector<Pose>& poses)
{
    FitOutcome outcome;
    for (int view = 0; view < views.count() && outcome.converged(); view++)
    {
        if (poses[view].found || !hasPoints(views, view))
            continue;
        outcome.status = FitOutcome::NO_POSE;
        outcome.view = view;
        for (bool direct : { true, false })
            for (const PoseSource& source : poseSources(views, view, direct))
                outcome.count = std::max(outcome.count, source.count);
    }
    return outcome;
}

}} // namespace
