// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Pose of a target seen through lens and window.

Start: every pixel's ray has its own origin; about the mean origin the rays are nearly central, so the pose is
found by cv::solvePnP on the rays' directions, in a frame that looks along their mean (wide lenses see beyond 90 degrees),
and moved by the mean origin. A planar target has two such poses (IPPE gives both); the likelihood decides. Few points in space
have several minima as well, of which the closed form knows one: all poses of three of them are starts (generalized_p3p.hpp). */

#include "pose/poses.hpp"
#include "pose/central_pose.hpp"
#include "pose/nearest_rays.hpp"
#include "pose/generalized_p3p.hpp"
#include "arrays/arrays.hpp"
#include "arrays/views.hpp"
#include "math/least_squares.hpp"
#include "math/rotation.hpp"
#include <array>
#include <set>

namespace cv { namespace refract {

int scatterRank(const std::vector<Point3d>& points)
{
    Vec3d mean;
    for (const Point3d& p : points)
        mean += Vec3d(p)/(double)points.size();
    Matx33d scatter = Matx33d::zeros();
    for (const Point3d& p : points)
        scatter += (Vec3d(p) - mean)*(Vec3d(p) - mean).t();
    Vec3d values;
    eigen(scatter, values);
    int rank = 0;
    for (int i = 0; i < 3; i++)
        rank += values[i] > 1e-12*values[0];    // squares: flat to one in a million
    return rank;
}

ImagePoints observedWhole(const std::vector<Point3d>& objectPoints, std::vector<Point2d> imagePoints)
{
    for (Point2d& pixel : imagePoints)
        if (!isWhole(pixel))
            pixel = Point2d(1, 1)*std::numeric_limits<double>::quiet_NaN();
    return observed(objectPoints, imagePoints);
}

int countDifferent(const ImagePoints& points)
{
    std::set<std::array<double, 5> > different;
    for (size_t i = 0; i < points.pixel.size(); i++)
        if (isWhole(points.pixel[i]))
            different.insert({ { points.object[i].x, points.object[i].y, points.object[i].z, points.pixel[i].x, points.pixel[i].y } });
    return (int)different.size();
}

double meanRange(const std::vector<Pose>& poses)
{
    double sum = 0;
    int count = 0;
    for (const Pose& pose : poses)
        if (pose.found)
        {
            sum += norm(pose.tvec);
            count++;
        }
    return sum/count;
}

Pose poseOf(const RigidTransform& transform)
{
    Pose pose;
    pose.rvec = rotationVector(transform.R);
    pose.tvec = transform.t;
    pose.found = true;
    return pose;
}

RigidTransform transformOf(const Pose& pose) { return { rotationMatrix(pose.rvec), pose.tvec }; }

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();

//! The points that have a ray in front, as a pinhole at the rays' mean origin sees them.
struct CentralView
{
    CentralView(const Camera& camera, const ImagePoints& points) : bearings(bearingsOf(camera, points.pixel))
    {
        for (size_t i = 0; i < points.pixel.size(); i++)
            if (isWhole(bearings.normalized[i]))
            {
                object.push_back(points.object[i]);
                normalized.push_back(bearings.normalized[i]);
            }
    }
    Bearings bearings;
    std::vector<Point3d> object;
    std::vector<Point2d> normalized;
};

//! Farthest distance of a point from the mean of all.
double radiusOf(const std::vector<Point3d>& points)
{
    Point3d mean;
    for (const Point3d& p : points)
        mean += p*(1./(double)points.size());
    double radius = 0;
    for (const Point3d& p : points)
        radius = std::max(radius, norm(p - mean));
    return radius;
}

/** SQPnP throws where an image is small (calib3d's POINT_VARIANCE_THRESHOLD). So small, it is to first order the magnified one of a
target that is so many times nearer; what is left a fit mends. Infinite where all points are at one place. */
double magnificationFor(const std::vector<Point2d>& normalized)
{
    const double REFUSED = 1.1e-5, MAGNIFIED = 1e-4, ROUNDING = 1e-24;
    Scalar mean, deviation;
    meanStdDev(normalized, mean, deviation);
    const double variance = deviation[0]*deviation[0] + deviation[1]*deviation[1];
    if (variance < ROUNDING*(1 + mean.dot(mean)))
        return std::numeric_limits<double>::infinity();
    return variance > REFUSED ? 1. : std::sqrt(MAGNIFIED/variance);
}

//! By one of calib3d's methods; none where it finds none that is finite.
std::vector<Pose> closedFormPoses(const CentralView& view, SolvePnPMethod method)
{
    const double unit = radiusOf(view.object);      // IPPE finds no pose of targets that are millions across
    std::vector<Point3d> object;
    for (const Point3d& p : view.object)
        object.push_back(p*(1/unit));
    const double magnification = method == SOLVEPNP_SQPNP ? magnificationFor(view.normalized) : 1.;
    if (std::isinf(magnification))
        return std::vector<Pose>();
    std::vector<Point2d> normalized;
    for (const Point2d& p : view.normalized)
        normalized.push_back(magnification*p);
    std::vector<Mat> rvecs, tvecs;
    solvePnPGeneric(object, normalized, Matx33d::eye(), noArray(), rvecs, tvecs, false, method);
    const Matx33d back = view.bearings.turn.t();
    std::vector<Pose> poses;
    for (size_t i = 0; i < rvecs.size(); i++)
    {
        if (!checkRange(rvecs[i]) || !checkRange(tvecs[i]))
            continue;
        Vec3d t(tvecs[i].ptr<double>());
        t[2] *= magnification;
        poses.push_back(poseOf({ back*rotationMatrix(Vec3d(rvecs[i].ptr<double>())), back*(unit*t) + view.bearings.centre }));
    }
    return poses;
}

std::vector<Pose> closedFormPoses(const Camera& camera, const ImagePoints& points)
{
    const CentralView view(camera, points);
    const int rank = view.object.size() < 4 ? 0 : scatterRank(view.object);
    std::vector<Pose> poses;
    if (rank == 2)
        poses = closedFormPoses(view, SOLVEPNP_IPPE);
    if (rank == 3 || (rank == 2 && poses.empty()))      // IPPE takes roots below zero of a plane exactly across the view
        poses = closedFormPoses(view, SOLVEPNP_SQPNP);
    return poses;
}

//! Reprojection errors of one image by the pose (rvec, tvec).
struct PoseErrors
{
    const Camera& camera;
    const ImagePoints& points;

    //! False where a point has no image.
    bool operator()(const Vec6d& pose, SumOfSquares<6>& sum) const
    {
        const Rotation object(pose.val);
        double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK], derivatives[6*BLOCK];
        uchar status[BLOCK];
        const Columns byPoint = { derivatives, 3, BLOCK }, none = { nullptr, camera.parameterCount(), BLOCK };
        for (int begin = 0; begin < (int)points.pixel.size(); begin += BLOCK)
        {
            const int n = std::min(BLOCK, (int)points.pixel.size() - begin);
            for (int k = 0; k < n; k++)
            {
                const Vec3d X = object.R*Vec3d(points.object[begin + k]) + Vec3d(pose.val + 3);
                x[k] = X[0]; y[k] = X[1]; z[k] = X[2];
                status[k] = REFRACT_OK;
            }
            camera.projectJacobian(n, x, y, z, u, v, byPoint, none, status);
            if (std::any_of(status, status + n, [](uchar s) { return s != REFRACT_OK; }))
                return false;
            for (int k = 0; k < n; k++)
            {
                const Matx33d byRvec = object.derivativeOf(Vec3d(points.object[begin + k]));
                const Vec2d error = points.error(begin + k, u[k], v[k]);
                for (int c = 0; c < 3 && !points.whitening.empty(); c++)
                    points.whitening[begin + k].apply(byPoint.at(0, c)[k], byPoint.at(1, c)[k]);
                for (int r = 0; r < 2; r++)
                {
                    double byPose[6];
                    for (int c = 0; c < 3; c++)
                    {
                        byPose[3 + c] = byPoint.at(r, c)[k];
                        byPose[c] = byPoint.at(r, 0)[k]*byRvec(0, c) + byPoint.at(r, 1)[k]*byRvec(1, c) +
                                    byPoint.at(r, 2)[k]*byRvec(2, c);
                    }
                    sum.add(error[r], byPose);
                }
            }
        }
        return true;
    }
};

} // namespace

//! @param here gets the errors there
static double refinePose(const Camera& camera, const ImagePoints& points, int iterations, Pose& pose, SumOfSquares<6>& here)
{
    const double count = (double)points.pixel.size();
    const LeastSquaresEnd end = { iterations, 2e-15*count, 1e-14 };         // square pixels
    Vec6d six(pose.rvec[0], pose.rvec[1], pose.rvec[2], pose.tvec[0], pose.tvec[1], pose.tvec[2]);
    const double sum = minimizeSquares(PoseErrors{ camera, points }, end, six, here);
    if (std::isnan(sum))            // a start that gives some point no image is none
        return NaN;
    pose.rvec = Vec3d(six.val);
    pose.tvec = Vec3d(six.val + 3);
    return std::sqrt(sum/count);
}

double refinePose(const Camera& camera, const ImagePoints& points, Pose& pose, int iterations)
{
    SumOfSquares<6> here;
    return refinePose(camera, points, iterations, pose, here);
}

Pose inCamera1(const Pose& inCamera, const Pose& extrinsics)
{
    return poseOf(transformOf(extrinsics).inverse()*transformOf(inCamera));
}

static bool isSame(const Pose& a, const Pose& b)
{
    const double ROUNDING = 1e-6;
    return norm(rotationMatrix(a.rvec) - rotationMatrix(b.rvec)) < ROUNDING && norm(a.tvec - b.tvec) < ROUNDING*norm(b.tvec);
}

//! The poses that put any three of the points on their rays.
static void addPosesOfTriples(const Camera& camera, const ImagePoints& points, std::vector<Pose>& poses)
{
    const PointRays rays(camera, points);
    const int count = (int)rays.ray.size();
    for (int i = 0; i < count; i++)
        for (int j = i + 1; j < count; j++)
            for (int k = j + 1; k < count; k++)
            {
                const SceneRay three[3] = { rays.ray[i], rays.ray[j], rays.ray[k] };
                const Vec3d object[3] = { points.object[rays.point[i]], points.object[rays.point[j]],
                                          points.object[rays.point[k]] };
                for (const RigidTransform& motion : allPosesOfThreeRays(three, object))
                    poses.push_back(poseOf(motion));
            }
}

static bool isNew(const std::vector<PoseMinimum>& minima, const PoseMinimum& minimum)
{
    return std::none_of(minima.begin(), minima.end(), [&](const PoseMinimum& other)
                        { return isSame(other.pose, minimum.pose); });
}

void sortByError(std::vector<PoseMinimum>& minima)
{
    std::stable_sort(minima.begin(), minima.end(), [](const PoseMinimum& a, const PoseMinimum& b) { return a.rms < b.rms; });
}

double coordinateRms(const Camera& camera, const ImagePoints& points, const PoseMinimum& minimum)
{
    if (points.whitening.empty())
        return minimum.rms/std::sqrt(2.);
    const RigidTransform motion = transformOf(minimum.pose);
    double sum = 0;
    for (size_t i = 0; i < points.pixel.size(); i++)
    {
        const Vec3d X = motion.apply(Vec3d(points.object[i]));
        Point2d pixel;
        uchar status = REFRACT_OK;
        camera.project(1, &X[0], &X[1], &X[2], nullptr, &pixel.x, &pixel.y, &status);
        sum += squaredDistance(pixel, points.pixel[i]);
    }
    return std::sqrt(sum/points.rows());
}

//! Where the search for minima begins, of few points the poses with the smallest errors.
static std::vector<Pose> startsOf(const Camera& camera, const ImagePoints& points)
{
    const size_t FEW = 5, MOST = 8;     // from six points on the closed form leads to the least minimum
    std::vector<Pose> poses = closedFormPoses(camera, points);
    if (points.pixel.size() > FEW)
        return poses;
    addPosesOfTriples(camera, points, poses);
    std::vector<PoseMinimum> starts;
    for (const Pose& pose : poses)
    {
        PoseMinimum start = { pose, 0 };
        start.rms = refinePose(camera, points, start.pose, 1);
        if (!std::isnan(start.rms) && isNew(starts, start))
            starts.push_back(start);
    }
    sortByError(starts);
    poses.clear();
    for (size_t i = 0; i < std::min(starts.size(), MOST); i++)
        poses.push_back(starts[i].pose);
    return poses;
}

//! False where a descent has ended as some point would lose its image: a step of Gauss-Newton would still lead on.
static bool isMinimum(const SumOfSquares<6>& here, size_t points)
{
    const double NOTHING = 1e-3, ROUNDING = 1e-9;       // part of the squares; square pixels of a point
    Vec6d step;
    return !dampedStep(here, Vec6d(), 0, step) || expectedGain(here, step) < NOTHING*here.value + ROUNDING*(double)points;
}

/** Maximum likelihood from a start. One of a target that is close to a window may be within that, or lead to it: from there it is moved
to the rays, which have no boundary, and away from the camera until all points have an image.
@param isAtBoundary gets whether the descent ended at the window, as points would leave the images beyond it: a start, no minimum */
static PoseMinimum refineShown(const Camera& camera, const ImagePoints& points, const Pose& start, bool& isAtBoundary)
{
    const int ITERATIONS = 100;
    SumOfSquares<6> here;
    PoseMinimum minimum = { start, NaN };
    minimum.rms = refinePose(camera, points, ITERATIONS, minimum.pose, here);
    isAtBoundary = std::isnan(minimum.rms) || !isMinimum(here, points.pixel.size());
    if (!isAtBoundary)
        return minimum;
    const Pose near = nearestToRays(camera, points, start);
    for (double farther : { 1., 1.03, 1.1, 1.25 })
    {
        PoseMinimum moved = { near, NaN };
        moved.pose.tvec *= farther;
        moved.rms = refinePose(camera, points, ITERATIONS, moved.pose, here);
        if (std::isnan(moved.rms))
            continue;
        minimum = moved;
        isAtBoundary = !isMinimum(here, points.pixel.size());
        break;
    }
    return minimum;
}

//! @param withBoundary also those that are no minima, see refineShown
static std::vector<PoseMinimum> descend(const Camera& camera, const ImagePoints& points, const Pose& start, bool withBoundary)
{
    std::vector<PoseMinimum> minima;
    if (points.rows() < 6 || scatterRank(points.object) < 2)
        return minima;
    for (const Pose& pose : start.found ? std::vector<Pose>(1, start) : startsOf(camera, points))
    {
        bool isAtBoundary;
        const PoseMinimum minimum = refineShown(camera, points, pose, isAtBoundary);
        if (!std::isnan(minimum.rms) && (withBoundary || !isAtBoundary) && isNew(minima, minimum))
            minima.push_back(minimum);
    }
    sortByError(minima);
    return minima;
}

std::vector<PoseMinimum> findMinima(const Camera& camera, const ImagePoints& points, const Pose& start)
{
    return descend(camera, points, start, false);
}

Pose solvePose(const Camera& camera, const std::vector<Point3d>& objectPoints, const std::vector<Point2d>& imagePoints,
               const Pose& start, double& rms)
{
    const std::vector<PoseMinimum> minima = descend(camera, observed(objectPoints, imagePoints), start, true);
    rms = minima.empty() ? NaN : minima[0].rms;
    return minima.empty() ? Pose() : minima[0].pose;
}

}} // namespace
