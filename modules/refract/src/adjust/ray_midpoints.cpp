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

//! @param isUsed per point of the image; empty: all
void addRays(const Camera& camera, const RigidTransform& camFromScene, const ImagePoints& points, const std::vector<uchar>& isUsed,
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
            const Vec3d origin = camFromScene.inverse(rays.origin(k, normal));
            if (isWhole(points.pixel[begin + k]))
                sum.addRay(origin, camFromScene.R.t()*rays.direction(k));
            else
                sum.addSheet(origin, camFromScene.R.t()*rays.normalOf(k));
        }
    }
}

bool hasImage(const Camera& camera, const RigidTransform& camFromScene, const Point3d& point)
{
    const Vec3d X = camFromScene.apply(Vec3d(point));
    double u, v;
    uchar status = REFRACT_OK;
    camera.project(1, &X[0], &X[1], &X[2], nullptr, &u, &v, &status);
    return status == REFRACT_OK;
}

} // namespace

std::vector<Point3d> startPoints(const Problem& problem, const std::vector<Point3d>& given)
{
    const Rig rig = problem.rig();
    std::vector<RaySum> sums(given.size());
    std::vector<int> seen(given.size(), 0);         // coordinates
    for (const Image& image : problem.images())
    {
        addRays(rig.cameras[image.camera], problem.camFromScene(image), image.points, std::vector<uchar>(), sums);
        for (size_t k = 0; k < image.points.index.size(); k++)
            seen[image.points.index[k]] += image.points.rowsOf(k);
    }
    std::vector<Point3d> points = given;
    for (size_t i = 0; i < points.size(); i++)
        if (seen[i] < 3)
            points[i] = Point3d(NaN, NaN, NaN);
        else if (!std::isfinite(given[i].x))
            points[i] = Point3d(sums[i].point()/problem.sceneScale());
    for (const Image& image : problem.images())
    {
        const RigidTransform camFromScene = problem.camFromScene(image);
        for (int index : image.points.index)
            if (std::isfinite(points[index].x) &&
                !hasImage(rig.cameras[image.camera], camFromScene, points[index]*problem.sceneScale()))
                points[index] = Point3d(NaN, NaN, NaN);
    }
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
            addRays(rig.cameras[image.camera], problem.camFromScene(image), image.points, isUsed[i], sums);
    }
    std::vector<Point3d> points;
    for (const RaySum& sum : sums)
        points.push_back(Point3d(sum.point()/problem.sceneScale()));
    return points;
}

}} // namespace
