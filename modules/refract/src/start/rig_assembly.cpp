// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Cameras that each know where the targets are in their own frame become a rig: views in common tell where they are. */

#include "start/rig_assembly.hpp"
#include "window/place.hpp"
#include "start/shared_window.hpp"

namespace cv { namespace refract {

namespace {

//! Camera a -> camera b, by a target's poses in both.
Pose camBFromCamA(const Pose& inA, const Pose& inB) { return poseOf(transformOf(inB)*transformOf(inA).inverse()); }

//! Sum of squared pixels of all views that the camera saw and that have a place, with the camera at these extrinsics.
double costAt(const CameraHypothesis& hypothesis, const Pose& extrinsics, const std::vector<Pose>& places, const CameraViews& seen,
              const std::vector<std::vector<Point3d> >& object)
{
    const double OUT_OF_SIGHT = 1e6;
    double cost = 0;
    for (size_t view = 0; view < places.size(); view++)
    {
        if (!places[view].found || !hypothesis.poses[view].found)
            continue;
        const RigidTransform camFromTarget = transformOf(extrinsics)*transformOf(places[view]);
        for (size_t i = 0; i < seen.refracted[view].size(); i++)       // none: a direct image alone
        {
            const Point2d& pixel = seen.refracted[view][i];
            if (!isWhole(pixel))
                continue;
            const Vec3d X = camFromTarget.apply(Vec3d(object[view][i]));
            double u = 0, v = 0;
            uchar status = REFRACT_OK;
            hypothesis.camera.project(1, &X[0], &X[1], &X[2], nullptr, &u, &v, &status);
            cost += status == REFRACT_OK ? std::min(norm(Point2d(u, v) - pixel), OUT_OF_SIGHT) : OUT_OF_SIGHT;
        }
    }
    return cost;
}

//! Where a camera is, by the view that tells it best for all that have a place; not found if it saw none of them.
Pose placeOf(const CameraHypothesis& hypothesis, const std::vector<Pose>& places, const CameraViews& seen,
             const std::vector<std::vector<Point3d> >& object)
{
    Pose best;
    double least = std::numeric_limits<double>::infinity();
    for (size_t view = 0; view < places.size(); view++)
    {
        if (!places[view].found || !hypothesis.poses[view].found)
            continue;
        const Pose extrinsics = camBFromCamA(places[view], hypothesis.poses[view]);
        const double cost = costAt(hypothesis, extrinsics, places, seen, object);
        if (cost < least)
        {
            least = cost;
            best = extrinsics;
        }
    }
    return best;
}

//! How many points the camera saw of targets that have a place.
int countPlaced(const CameraHypothesis& hypothesis, const std::vector<Pose>& places, const CameraViews& seen)
{
    int count = 0;
    for (size_t view = 0; view < places.size(); view++)
        if (places[view].found && hypothesis.poses[view].found)
            count += countWhole(seen.refracted[view]);
    return count;
}

//! The cameras' order is no matter of the caller's: the next is the one that saw most of what has a place; -1: none did.
int nextCamera(const std::vector<CameraHypothesis>& cameras, const std::vector<bool>& isPlaced, const std::vector<Pose>& places,
               const RigViews& views)
{
    int next = -1, most = 0;
    for (size_t c = 0; c < cameras.size(); c++)
    {
        const int count = isPlaced[c] ? 0 : countPlaced(cameras[c], places, views.cameras[c]);
        if (count <= most)
            continue;
        most = count;
        next = (int)c;
    }
    return next;
}

//! Places the cameras one after the other, by views in common with those before; those without stay where they are.
struct Placement
{
    Placement(const std::vector<CameraHypothesis>& cameras, const RigViews& views, int root)
        : places(cameras.size()), isPlaced(cameras.size(), false), poses(cameras[root].poses)
    {
        isPlaced[root] = true;
        for (int c = nextCamera(cameras, isPlaced, poses, views); c >= 0; c = nextCamera(cameras, isPlaced, poses, views))
        {
            places[c] = placeOf(cameras[c], poses, views.cameras[c], views.object);
            isPlaced[c] = true;
            for (int view = 0; view < views.count(); view++)
                if (!poses[view].found && cameras[c].poses[view].found)
                    poses[view] = inCamera1(cameras[c].poses[view], places[c]);
        }
    }
    std::vector<Pose> places;       //!< root -> camera
    std::vector<bool> isPlaced;
    std::vector<Pose> poses;        //!< of the targets, in the root's frame
};

//! The camera that saw most.
int bestObserver(const RigViews& views)
{
    int best = 0, most = -1;
    for (size_t c = 0; c < views.cameras.size(); c++)
    {
        int seen = 0;
        for (const std::vector<Point2d>& pixels : views.cameras[c].refracted)
            seen += countWhole(pixels);
        if (seen <= most)
            continue;
        most = seen;
        best = (int)c;
    }
    return best;
}

//! From the camera that saw most, if that leads to camera 1, whose frame all are in.
void placeCameras(const std::vector<CameraHypothesis>& cameras, const RigViews& views, RigStart& start)
{
    int root = bestObserver(views);
    Placement placement(cameras, views, root);
    if (!placement.isPlaced[0])
    {
        root = 0;
        placement = Placement(cameras, views, root);
    }
    const Pose toCamera1 = placement.places[0];
    start.poses = placement.poses;
    for (Pose& pose : start.poses)
        if (root != 0 && pose.found)
            pose = poseOf(transformOf(toCamera1)*transformOf(pose));
    for (size_t c = 1; c < cameras.size(); c++)
        if (placement.isPlaced[c])
            start.rig.extrinsics[c] = root == 0 ? placement.places[c] : camBFromCamA(toCamera1, placement.places[c]);
}

} // namespace

std::vector<CameraHypothesis> camerasOf(const Minimum& minimum, const std::vector<CameraHypothesis>& before)
{
    std::vector<CameraHypothesis> cameras = before;
    for (int c = 0; c < minimum.rig.count(); c++)
    {
        cameras[c].camera = minimum.rig.cameras[c];
        for (size_t view = 0; view < cameras[c].poses.size(); view++)
        {
            Pose& pose = cameras[c].poses[view];
            if (!pose.found)
                continue;
            pose = poseOf(transformOf(minimum.rig.extrinsics[c])*transformOf(minimum.poses[view]));
            pose.found = minimum.poses[view].found;
        }
    }
    return cameras;
}

bool assemble(const Rig& given, const std::vector<CameraHypothesis>& cameras, const std::vector<int>& windowFrom,
              const RigViews& views, int flags, RigStart& start)
{
    start = { given, std::vector<Pose>() };
    placeCameras(cameras, views, start);
    for (int c = 0; c < given.count(); c++)
        start.rig.cameras[c] = cameras[c].camera;
    for (int c = 0; c < given.count(); c++)
    {
        const int from = windowFrom[c];
        if (!given.owns(c))
            continue;
        GlassWindow window = transferred(cameras[from].camera.window(), start.rig.extrinsics[from], start.rig.extrinsics[c]);
        if (!(window.normal[2] > 0 && distanceToSurface(window) >= 0))
            return false;
        if (!(flags & GLASS_FREE_DISTANCE))
            window.distance = given.cameras[c].window().distance;
        start.rig.cameras[c].setWindow(window);
    }
    if (flags & GLASS_FREE_DISTANCE)
        giveToNearest(start.rig);
    return transferToOthers(start.rig).converged();
}

//! Where a camera by itself sees the targets.
static CameraHypothesis alone(const Camera& camera, const RigViews& all, int c)
{
    const Rig rig = { { camera }, { 0 }, { Pose() } };
    RigViews views = all;
    views.cameras.assign(1, all.cameras[c]);
    std::vector<Pose> poses = posesWithoutWindow(rig, views, std::vector<Pose>());
    addPosesThroughWindow(rig, views, poses);
    return { camera, poses };
}

bool placeByViews(const RigViews& views, const std::vector<Pose>& known, Rig& rig)
{
    const double CLEARLY = 0.5;         // part of the pixels that are left where the camera is given
    std::vector<CameraHypothesis> cameras;
    for (int c = 0; c < rig.count(); c++)
        cameras.push_back(alone(rig.cameras[c], views, c));
    for (size_t view = 0; view < known.size(); view++)
        if (known[view].found)
            cameras[0].poses[view] = known[view];
    const Placement placement(cameras, views, 0);
    Rig placed = rig;
    bool isBetter = false;
    for (int c = 1; c < rig.count(); c++)
    {
        const auto cost = [&](const Pose& place) { return costAt(cameras[c], place, placement.poses, views.cameras[c], views.object); };
        if (!placement.places[c].found || !(cost(placement.places[c]) < CLEARLY*cost(rig.extrinsics[c])))
            continue;
        placed.extrinsics[c] = placement.places[c];
        isBetter = true;
    }
    if (!isBetter || !transferToOthers(placed).converged())
        return false;
    rig = placed;
    return true;
}

}} // namespace
