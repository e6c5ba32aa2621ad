// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Of a camera that turns and hardly moves, refraction alone tells how far points are: rays of one point differ by little more than what
poses are off by, and where they come closest is anywhere. Directions are known: points are put on the rays of one view, at the distance D
at which a length L is seen under its angle, L = D |u_a - u_b|, and the other views follow from them, along a tree. */

#include "start/one_distance.hpp"
#include "adjust/ray_midpoints.hpp"
#include "adjust/view_motion.hpp"
#include "math/robust_scale.hpp"
#include "pose/generalized_p3p.hpp"
#include "pose/poses.hpp"
#include <map>

namespace cv { namespace refract {

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();

//! Of an image's points, in the frame of its camera; NaN where there is none.
typedef std::vector<SceneRay> ImageRays;

ImageRays raysOf(const Camera& camera, const ImagePoints& points)
{
    ImageRays all(points.pixel.size(), SceneRay{ Vec3d::all(NaN), Vec3d::all(NaN) });
    const PointRays found(camera, points);
    for (size_t k = 0; k < found.ray.size(); k++)
        all[found.point[k]] = found.ray[k];
    return all;
}

std::vector<ImageRays> raysOf(const Problem& problem)
{
    const Rig rig = problem.rig();
    std::vector<ImageRays> rays;
    for (const Image& image : problem.images())
        rays.push_back(raysOf(rig.cameras[image.camera], image.points));
    return rays;
}

//! At which this length is seen under its angle, by each image that shows both of its ends.
void addDistances(const Problem& problem, const std::vector<ImageRays>& rays, int cluster, const KnownLength& length,
                  std::vector<double>& distances)
{
    std::map<int, Vec3d> toFirst, toSecond;         // by image
    const std::vector<int>& points = problem.scene().clusters()[cluster].points;
    for (const Observation& o : problem.observationsOf(cluster))
    {
        const int point = problem.images()[o.image].points.index[o.row];
        if (point == points[length.a])
            toFirst[o.image] = rays[o.image][o.row].direction;
        else if (point == points[length.b])
            toSecond[o.image] = rays[o.image][o.row].direction;
    }
    for (const std::pair<const int, Vec3d>& first : toFirst)
        if (toSecond.count(first.first))
        {
            const double distance = length.length/norm(first.second - toSecond[first.first]);
            if (std::isfinite(distance))
                distances.push_back(distance);
        }
}

/** Lengths that lie askew look shorter, so that they tell more: the nearest tenth is believed. From half of that points find their way
outwards; from beyond they may not find it back, as there they have no way to go. NaN: no length tells. */
double distanceOf(const Problem& problem, const std::vector<ImageRays>& rays)
{
    std::vector<double> distances;
    for (int i = 0; i < (int)problem.scene().clusters().size(); i++)
        for (const KnownLength& length : problem.scene().clusters()[i].lengths)
            addDistances(problem, rays, i, length, distances);
    std::sort(distances.begin(), distances.end());
    return distances.empty() ? NaN : 0.5*distances[distances.size()/10];
}

//! Points that are placed, or not yet.
class Placing
{
public:
    explicit Placing(Problem& problem)
        : problem_(problem), rig_(problem.rig()), rays_(raysOf(problem)), distance_(distanceOf(problem, rays_)*problem.sceneScale()),
          points_(problem.scene().pointCount(), Vec3d::all(NaN)) {}
    bool isPossible() const { return std::isfinite(distance_); }

    //! On the rays of this view, those that are not yet.
    void placePointsOf(int view)
    {
        for (int i : problem_.imagesOf(view))
        {
            const Image& image = problem_.images()[i];
            const RigidTransform camFromScene = problem_.camFromScene(image);
            for (size_t row = 0; row < image.points.index.size(); row++)
            {
                Vec3d& point = points_[image.points.index[row]];
                if (std::isnan(point[0]) && !std::isnan(rays_[i][row].direction[0]))
                    point = camFromScene.inverse(rays_[i][row].origin + distance_*rays_[i][row].direction);
            }
        }
    }

    //! By the image that shows most of the points that are placed.
    void placeView(int view)
    {
        const int ENOUGH = 4;
        ImagePoints most;
        const Image* best = nullptr;
        for (int i : problem_.imagesOf(view))
        {
            const ImagePoints placed = placedIn(problem_.images()[i]);
            if (placed.pixel.size() > std::max(most.pixel.size(), (size_t)ENOUGH - 1))
            {
                most = placed;
                best = &problem_.images()[i];
            }
        }
        if (!best)
            return;
        Pose pose = poseOf(problem_.camFromScene(*best));
        pose.found = true;
        if (!std::isnan(refinePose(rig_.cameras[best->camera], most, pose)))
            problem_.setPose(view, inCamera1(pose, rig_.extrinsics[best->camera]));
    }

    void finish()
    {
        std::vector<Point3d> points;
        for (const Vec3d& point : points_)
            points.push_back(Point3d(point/problem_.sceneScale()));
        problem_.setPoints(startPoints(problem_, points), std::vector<std::vector<uchar> >());
    }

private:
    ImagePoints placedIn(const Image& image) const
    {
        ImagePoints placed;
        for (size_t row = 0; row < image.points.index.size(); row++)
        {
            const Vec3d& point = points_[image.points.index[row]];
            if (std::isnan(point[0]) || !isWhole(image.points.pixel[row]))
                continue;
            placed.object.push_back(Point3d(point));
            placed.pixel.push_back(image.points.pixel[row]);
            placed.index.push_back(image.points.index[row]);
        }
        return placed;
    }

    Problem& problem_;
    const Rig rig_;
    const std::vector<ImageRays> rays_;
    const double distance_;
    std::vector<Vec3d> points_;     //!< frame of the scene
};

} // namespace

bool areRaysParallel(const Problem& problem)
{
    const double PARALLEL = 0.03;       // radians: one to two degrees
    bool isAnyFree = false;
    for (int view = 0; view < problem.viewCount(); view++)
        isAnyFree = isAnyFree || problem.isAdjusted(view);
    if (!isAnyFree)
        return false;
    const std::vector<ImageRays> rays = raysOf(problem);
    std::vector<Vec3d> sums(problem.scene().pointCount());
    std::vector<int> counts(sums.size(), 0);
    for (size_t i = 0; i < rays.size(); i++)
    {
        const Image& image = problem.images()[i];
        const RigidTransform camFromScene = problem.camFromScene(image);
        for (size_t row = 0; row < image.points.index.size(); row++)
            if (!std::isnan(rays[i][row].direction[0]))
            {
                sums[image.points.index[row]] += camFromScene.R.t()*rays[i][row].direction;
                counts[image.points.index[row]]++;
            }
    }
    std::vector<double> angles;         // RMS about the mean: of n units |sum|^2/n^2 is 1 less their variance
    for (size_t k = 0; k < sums.size(); k++)
        if (counts[k] > 1)
            angles.push_back(std::sqrt(std::max(0., 1 - sums[k].dot(sums[k])/std::pow(counts[k], 2))));
    return !angles.empty() && median(angles) < PARALLEL;
}

bool placeAtOneDistance(Problem& problem)
{
    Placing placing(problem);
    if (!placing.isPossible())
        return false;
    const ViewGraph graph(problem);
    for (int view = 0; view < problem.viewCount(); view++)
        if (graph.isRoot[view])
            placing.placePointsOf(view);
    for (const ViewEdge& edge : graph.tree)
    {
        placing.placeView(edge.to);
        placing.placePointsOf(edge.to);
    }
    placing.finish();
    return true;
}

}} // namespace
