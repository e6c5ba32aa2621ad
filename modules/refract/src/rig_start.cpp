// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "rig_start.hpp"
#include "calibrate_normal.hpp"
#include "rig_problem.hpp"
#include "rotation.hpp"

namespace cv { namespace refract {

namespace {

// The first search needs the rough shape of the cost only.
const int SEARCH_VIEWS = 8, SEARCH_FITS = 4;

//! The given normal first, then tilts from the optical axis.
std::vector<Vec3d> candidateNormals(const Vec3d& given)
{
    std::vector<Vec3d> normals(1, given);
    normals.push_back(Vec3d(0, 0, 1));
    for (double tilt : { 0.2, 0.45 })
        for (int i = 0; i < 8; i++)
        {
            const double azimuth = i*CV_PI/4;
            normals.push_back(Vec3d(std::sin(tilt)*std::cos(azimuth), std::sin(tilt)*std::sin(azimuth), std::cos(tilt)));
        }
    return normals;
}

Camera withNormal(const Camera& camera, const Vec3d& normal)
{
    Camera turned(camera);
    GlassWindow window = camera.window();
    window.normal = normal;
    turned.setWindow(window);
    return turned;
}

int countSeen(const std::vector<Point2d>& pixels)
{
    return (int)std::count_if(pixels.begin(), pixels.end(), isSeen);
}

//! What the camera saw through the window: every view, or so many of them evenly.
RigViews searchViews(const PixelViews& refracted, const std::vector<std::vector<Point3d> >& object, int atMost)
{
    std::vector<int> good;
    for (int i = 0; i < (int)refracted.size(); i++)
        if (countSeen(refracted[i]) >= 4)
            good.push_back(i);
    RigViews views;
    views.cameras.resize(1);
    const int count = std::min(atMost, (int)good.size());
    for (int i = 0; i < count; i++)
    {
        const int view = good[i*good.size()/count];
        views.object.push_back(object[view]);
        views.cameras[0].refracted.push_back(refracted[view]);
    }
    views.cameras[0].direct.resize(count);
    return views;
}

struct Candidate
{
    Vec3d normal;
    std::vector<Pose> poses;
    double cost;        //!< sum of squared residuals; infinite if a view has no pose
    bool operator<(const Candidate& other) const { return cost < other.cost; }
};

//! The best poses with this normal, started from others.
Candidate tryNormal(const Camera& camera, const Vec3d& normal, const RigViews& views, const std::vector<Pose>& starts)
{
    Candidate candidate = { normal, starts, 0 };
    const Camera turned = withNormal(camera, normal);
    for (int i = 0; i < views.count(); i++)
    {
        const std::vector<Point2d>& pixels = views.cameras[0].refracted[i];
        double rms;
        candidate.poses[i] = solvePose(turned, views.object[i], pixels, starts[i], rms);
        if (!candidate.poses[i].found)
            candidate.cost = std::numeric_limits<double>::infinity();
        else
            candidate.cost += rms*rms*countSeen(pixels);
    }
    return candidate;
}

//! All candidates that have poses, the best first.
std::vector<Candidate> tryNormals(const Camera& camera, const RigViews& views)
{
    std::vector<Candidate> candidates;
    std::vector<Pose> starts(views.count());
    for (const Vec3d& normal : candidateNormals(camera.layers().normal()))
    {
        const Candidate candidate = tryNormal(camera, normal, views, starts);
        if (!std::isfinite(candidate.cost))
            continue;
        candidates.push_back(candidate);
        starts = candidate.poses;
    }
    std::stable_sort(candidates.begin(), candidates.end());
    return candidates;
}

//! Fits the window to the views; returns the cost.
double fitWindow(const Camera& camera, const RigViews& views, const std::vector<Pose>& poses, int flags,
                 GlassWindow& window)
{
    RigProblem rig(std::vector<Camera>(1, camera), Pose(), views, poses, flags & GLASS_FREE_DISTANCE);
    rig.solve(TermCriteria(TermCriteria::COUNT | TermCriteria::EPS, 100, 1e-6));
    window = rig.camera(0).window();
    return rig.squaredError();
}

struct PoseSource
{
    bool direct;
    int camera, count;
    bool operator<(const PoseSource& other) const
    { return direct != other.direct ? direct : count > other.count; }
};

std::vector<PoseSource> poseSources(const RigViews& views, int view)
{
    std::vector<PoseSource> sources;
    for (int c = 0; c < (int)views.cameras.size(); c++)
        for (bool direct : { true, false })
        {
            const PixelViews& pixels = direct ? views.cameras[c].direct : views.cameras[c].refracted;
            const PoseSource source = { direct, c, countSeen(pixels[view]) };
            if (source.count >= 4)
                sources.push_back(source);
        }
    std::stable_sort(sources.begin(), sources.end());
    return sources;
}

Pose inCamera1(const Pose& inCamera2, const Pose& extrinsics)
{
    const Matx33d Rt = rotationMatrix(extrinsics.rvec).t();
    Pose pose;
    pose.rvec = rotationVector(Rt*rotationMatrix(inCamera2.rvec));
    pose.tvec = Rt*(inCamera2.tvec - extrinsics.tvec);
    pose.found = true;
    return pose;
}

} // namespace

GlassWindow startWindow(const Camera& camera, const CameraViews& seen, const std::vector<std::vector<Point3d> >& object,
                        int flags)
{
    GlassWindow window = camera.window();
    const NormalEstimate fromPairs = normalFromPairs(camera, seen.direct, seen.refracted);
    if (fromPairs.undetermined.empty() && fromPairs.normal[2] > 0)
        window.normal = fromPairs.normal;
    if (fromPairs.undetermined.empty() || (flags & GLASS_FREE_INTRINSICS))
        return window;

    const RigViews some = searchViews(seen.refracted, object, SEARCH_VIEWS);
    if (some.count() == 0)
        return window;
    const std::vector<Candidate> candidates = tryNormals(camera, some);
    std::vector<GlassWindow> starts(1, window);
    for (size_t i = 0; i < std::min(candidates.size(), (size_t)SEARCH_FITS); i++)
    {
        starts.push_back(window);
        fitWindow(withNormal(camera, candidates[i].normal), some, candidates[i].poses, flags, starts.back());
    }

    // Some views may have their least cost in another minimum than all have.
    const RigViews all = searchViews(seen.refracted, object, (int)seen.refracted.size());
    double least = std::numeric_limits<double>::infinity();
    for (const GlassWindow& start : starts)
    {
        Camera camera1(camera);
        camera1.setWindow(start);
        const Candidate placed = tryNormal(camera1, start.normal, all, std::vector<Pose>(all.count()));
        if (!std::isfinite(placed.cost))
            continue;
        GlassWindow fitted;
        const double cost = fitWindow(camera1, all, placed.poses, flags, fitted);
        if (!(cost < least))
            continue;
        least = cost;
        window = fitted;
    }
    return window;
}

std::vector<Pose> startPoses(const std::vector<Camera>& cameras, const Pose& extrinsics, const RigViews& views)
{
    std::vector<Pose> poses(views.count());
    for (int view = 0; view < views.count(); view++)
    {
        const std::vector<PoseSource> sources = poseSources(views, view);
        for (size_t i = 0; i < sources.size() && !poses[view].found; i++)
        {
            const PoseSource& source = sources[i];
            const CameraViews& seen = views.cameras[source.camera];
            Camera camera(cameras[source.camera]);
            if (source.direct)
                camera.setWindow(GlassWindow());
            double rms;
            const Pose pose = solvePose(camera, views.object[view], (source.direct ? seen.direct : seen.refracted)[view],
                                        Pose(), rms);
            if (pose.found)
                poses[view] = source.camera == 1 ? inCamera1(pose, extrinsics) : pose;
        }
        if (!poses[view].found)
            CV_Error_(Error::StsBadArg, ("view %d: no pose of the target was found; %s", view,
                                         sources.empty() ? "fewer than 4 of its points were seen in one image" :
                                         "its points lie on a line, do not fit the target, or lie behind the window"));
    }
    return poses;
}

}} // namespace
