// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "rig_start.hpp"
#include "calibrate_normal.hpp"
#include "rotation.hpp"

namespace cv { namespace refract {

namespace {

// The search needs the rough shape of the cost only.
const int SEARCH_VIEWS = 8;

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

//! Every view, or SEARCH_VIEWS of them evenly.
std::vector<int> searchViews(const PixelViews& refracted)
{
    std::vector<int> good;
    for (int i = 0; i < (int)refracted.size(); i++)
        if (countSeen(refracted[i]) >= 4)
            good.push_back(i);
    std::vector<int> chosen;
    const int count = std::min(SEARCH_VIEWS, (int)good.size());
    for (int i = 0; i < count; i++)
        chosen.push_back(good[i*good.size()/count]);
    return chosen;
}

//! Sum of squared residuals of the views' best poses; infinite if one has none.
double searchCost(const Camera& camera, const CameraViews& seen, const std::vector<std::vector<Point3d> >& object,
                  const std::vector<int>& views, std::vector<Pose>& poses)
{
    double cost = 0;
    for (size_t i = 0; i < views.size(); i++)
    {
        const std::vector<Point2d>& pixels = seen.refracted[views[i]];
        double rms;
        const Pose pose = solvePose(camera, object[views[i]], pixels, poses[i], rms);
        if (!pose.found)
            return std::numeric_limits<double>::infinity();
        poses[i] = pose;
        cost += rms*rms*countSeen(pixels);
    }
    return cost;
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

Vec3d startNormal(const Camera& camera, const CameraViews& seen, const std::vector<std::vector<Point3d> >& object,
                  bool lensIsKnown)
{
    const NormalEstimate fromPairs = normalFromPairs(camera, seen.direct, seen.refracted);
    if (fromPairs.undetermined.empty() && fromPairs.normal[2] > 0)
        return fromPairs.normal;
    const Vec3d given = camera.layers().normal();
    if (!lensIsKnown)
        return given;

    const std::vector<int> views = searchViews(seen.refracted);
    std::vector<Pose> poses(views.size());
    Vec3d best = given;
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3d& normal : candidateNormals(given))
    {
        std::vector<Pose> tried(poses);
        const double cost = searchCost(withNormal(camera, normal), seen, object, views, tried);
        if (!(cost < least))
            continue;
        least = cost;
        best = normal;
        poses = tried;
    }
    return best;
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
