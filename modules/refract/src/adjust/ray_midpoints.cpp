// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The point X that is nearest to rays o_i + s d_i in the sense of least squares: sum (I - d_i d_i^T) (X - o_i) = 0. Of half a pixel
with the sheet's normal m it is the plane: m_i m_i^T (X - o_i). */

#include "adjust/ray_midpoints.hpp"
#include "arrays/arrays.hpp"
#include "math/dense.hpp"
#include "points/sheet.hpp"

namespace cv { namespace refract {

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();

//! What the rays to one point add up to.
struct RaySum
{
    Matx33d across = Matx33d::zeros();
    Vec3d offset;
    int coordinates = 0;

    void addRay(const Vec3d& origin, const Vec3d& direction) { add(Matx33d::eye() - direction*direction.t(), origin, 2); }
    void addSheet(const Vec3d& origin, const Vec3d& normal) { add(normal*normal.t(), origin, 1); }
    void add(const Matx33d& projector, const Vec3d& origin, int own)
    {
        across += projector;
        offset += projector*origin;
        coordinates += own;
    }

    Vec3d point() const
    {
        const double PARALLEL = 1e-12;      // squared sine
        const SymmetricEigen3 eigen((Eigen::Map<const Eigen::Matrix3d>(across.val)));      // symmetric: by rows or columns
        if (coordinates < 3 || !(eigen.values[0] > 0.5*PARALLEL*coordinates))
            return Vec3d::all(NaN);
        return across.inv(DECOMP_CHOLESKY)*offset;
    }
};

//! Scene -> camera of an image.
RigidTransform placeOf(const Problem& problem, const Rig& cameras, const Image& image)
{
    return transformOf(cameras.extrinsics[image.camera])*transformOf(problem.pose(image.view));
}

//! @param isUsed per point of the image; empty: all
void addRays(const Camera& camera, const RigidTransform& place, const ImagePoints& points, const std::vector<uchar>& isUsed,
             std::vector<RaySum>& sums)
{
    const Vec3d normal = camera.layers().normal();
    for (int begin = 0; begin < (int)points.pixel.size(); begin += BLOCK)
    {
        const int n = std::min(BLOCK, (int)points.pixel.size() - begin);
        double u[BLOCK], v[BLOCK];
        Sheets rays;
        uchar status[BLOCK];
        for (int k = 0; k < n; k++)
        {
            u[k] = points.pixel[begin + k].x;
            v[k] = points.pixel[begin + k].y;
            status[k] = REFRACT_OK;
        }
        if (points.whitening.empty())
            camera.unproject(n, u, v, rays, status);
        else
            unprojectSheets(camera, n, u, v, rays, status);
        for (int k = 0; k < n; k++)
        {
            if (status[k] != REFRACT_OK || (!isUsed.empty() && !isUsed[begin + k]))
                continue;
            RaySum& sum = sums[points.index[begin + k]];
            const Vec3d origin = place.inverse(rays.origin(k, normal));
            if (isWhole(points.pixel[begin + k]))
                sum.addRay(origin, place.R.t()*rays.direction(k));
            else
                sum.addSheet(origin, place.R.t()*rays.normalOf(k));
        }
    }
}

//! Squared, from where points of an image are seen to where they are projected; infinite without image; NaN: the point is not known.
std::vector<double> squaredErrors(const Camera& camera, const RigidTransform& place, double scale, const ImagePoints& image,
                                  const std::vector<Point3d>& points)
{
    std::vector<double> errors(image.index.size(), NaN);
    for (int begin = 0; begin < (int)errors.size(); begin += BLOCK)
    {
        const int n = std::min(BLOCK, (int)errors.size() - begin);
        double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK];
        uchar status[BLOCK];
        for (int k = 0; k < n; k++)
        {
            const Point3d& point = points[image.index[begin + k]];
            const Vec3d X = std::isfinite(point.x) ? place.apply(Vec3d(point)*scale) : Vec3d(0, 0, 1);
            x[k] = X[0]; y[k] = X[1]; z[k] = X[2];
            status[k] = REFRACT_OK;
        }
        camera.project(n, x, y, z, nullptr, u, v, status);
        for (int k = 0; k < n; k++)
            if (std::isfinite(points[image.index[begin + k]].x))
                errors[begin + k] = status[k] == REFRACT_OK ? squaredDistance(Point2d(u[k], v[k]), image.pixel[begin + k])
                                                            : std::numeric_limits<double>::infinity();
    }
    return errors;
}

//! Of each point the largest of its squared errors; infinite where one image cannot see it.
std::vector<double> worstErrors(const Problem& problem, const Rig& rig, const std::vector<Point3d>& points)
{
    const std::vector<Image>& images = problem.images();
    std::vector<std::vector<double> > errors(images.size());
    parallel_for_(Range(0, (int)images.size()), [&](const Range& range)
    {
        for (int i = range.start; i < range.end; i++)
            errors[i] = squaredErrors(rig.cameras[images[i].camera], placeOf(problem, rig, images[i]), problem.sceneScale(),
                                      images[i].points, points);
    });
    std::vector<double> worst(points.size(), 0.);
    for (size_t i = 0; i < images.size(); i++)
        for (size_t k = 0; k < errors[i].size(); k++)
            if (errors[i][k] > worst[images[i].points.index[k]])
                worst[images[i].points.index[k]] = errors[i][k];
    return worst;
}

//! Squared, of all pixels: no two are farther apart.
double squaredExtent(const Problem& problem)
{
    const double inf = std::numeric_limits<double>::infinity();
    Point2d least(inf, inf), most(-inf, -inf);
    for (const Image& image : problem.images())
        for (const Point2d& p : image.points.pixel)     // a coordinate that is not known counts for none
        {
            least = Point2d(p.x < least.x ? p.x : least.x, p.y < least.y ? p.y : least.y);
            most = Point2d(p.x > most.x ? p.x : most.x, p.y > most.y ? p.y : most.y);
        }
    return squaredDistance(least, most);
}

} // namespace

std::vector<Point3d> startPoints(const Problem& problem, const std::vector<Point3d>& given)
{
    const Rig rig = problem.rig();
    std::vector<RaySum> sums(given.size());
    std::vector<int> seen(given.size(), 0);         // coordinates
    for (const Image& image : problem.images())
    {
        addRays(rig.cameras[image.camera], placeOf(problem, rig, image), image.points, std::vector<uchar>(), sums);
        for (size_t k = 0; k < image.points.index.size(); k++)
            seen[image.points.index[k]] += image.points.rowsOf(k);
    }
    std::vector<Point3d> points = given;
    for (size_t i = 0; i < points.size(); i++)
        if (seen[i] < 3)
            points[i] = Point3d(NaN, NaN, NaN);
        else if (!std::isfinite(given[i].x))
            points[i] = Point3d(sums[i].point()/problem.sceneScale());
    const std::vector<double> worst = worstErrors(problem, rig, points);
    // Where rays pass far from each other, what is nearest to them may lie anywhere. From beyond all images no step leads back.
    const double most = squaredExtent(problem);
    for (size_t i = 0; i < points.size(); i++)
        if (std::isinf(worst[i]) || (worst[i] > most && !std::isfinite(given[i].x)))
            points[i] = Point3d(NaN, NaN, NaN);
    return points;
}

std::vector<Point3d> rayMidpoints(const Problem& problem, int pointCount, const std::vector<std::vector<uchar> >& isUsed)
{
    const Rig rig = problem.rig();
    std::vector<RaySum> sums(pointCount);
    for (size_t i = 0; i < isUsed.size(); i++)
    {
        const Image& image = problem.images()[i];
        if (std::any_of(isUsed[i].begin(), isUsed[i].end(), [](uchar used) { return used != 0; }))
            addRays(rig.cameras[image.camera], placeOf(problem, rig, image), image.points, isUsed[i], sums);
    }
    std::vector<Point3d> points;
    for (const RaySum& sum : sums)
        points.push_back(Point3d(sum.point()/problem.sceneScale()));
    return points;
}

}} // namespace
