// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* With the normal n, a ray v in the camera and a point X of the target, seen with the pose R, t:

    v^T [n]x (R X + t) = 0,     so v^T M (X, 1) = 0 with M = [n]x (R | t) = B W

where the columns of B are two directions across n. For each n the best W of a view is an eigenvector, and its eigenvalue the sum of
squares: two angles are left to search. */

#include "start/coplanarity.hpp"
#include "math/dense.hpp"
#include "math/rotation.hpp"
#include "start/multi_start.hpp"

namespace cv { namespace refract {

namespace {

//! The rows v x P of a view's points, P homogeneous in its principal axes, of unit size.
struct ViewRows
{
    Eigen::MatrixXd R;      //!< R^T R is the sum of the rows' squares
    int dimension;          //!< of P
    int freedom;            //!< behind a normal that is known
};

//! The axes in which points are scattered, of a flat target two; empty if there are fewer.
std::vector<Vec3d> principalAxes(const std::vector<Point3d>& points, Vec3d& mean, double& size)
{
    const double FLAT = 1e-6;       // squares
    mean = Vec3d();
    for (const Point3d& p : points)
        mean += Vec3d(p)*(1./(double)points.size());
    Matx33d scatter = Matx33d::zeros(), vectors;
    for (const Point3d& p : points)
        scatter += (Vec3d(p) - mean)*(Vec3d(p) - mean).t()*(1./(double)points.size());
    Vec3d values;
    eigen(scatter, values, vectors);
    size = std::sqrt(values[0]);
    std::vector<Vec3d> axes;
    for (int i = 0; i < 3; i++)
        if (values[i] > FLAT*values[0])
            axes.push_back(Vec3d(vectors(i, 0), vectors(i, 1), vectors(i, 2)));
    return axes;
}

bool findRows(const Camera& camera, const std::vector<Point3d>& object, const std::vector<Point2d>& pixels, ViewRows& found)
{
    std::vector<Point3d> seen;
    std::vector<Vec3d> rays;
    for (size_t i = 0; i < pixels.size(); i++)
    {
        Vec3d ray;
        uchar status = REFRACT_OK;
        if (isWhole(pixels[i]))
            camera.lens().unproject(1, &pixels[i].x, &pixels[i].y, &ray[0], &ray[1], &ray[2], &status);
        if (!isWhole(pixels[i]) || status != REFRACT_OK)
            continue;
        seen.push_back(object[i]);
        rays.push_back(ray);
    }
    if (seen.empty())
        return false;
    Vec3d mean;
    double size;
    const std::vector<Vec3d> axes = principalAxes(seen, mean, size);
    found.dimension = (int)axes.size() + 1;
    if (found.dimension < 3 || (int)seen.size() < 2*found.dimension)
        return false;
    found.freedom = (int)seen.size() - (2*found.dimension - 1);
    Eigen::MatrixXd rows(seen.size(), 3*found.dimension);
    for (size_t i = 0; i < seen.size(); i++)
        for (int k = 0; k < found.dimension; k++)
        {
            const double p = k < (int)axes.size() ? axes[k].dot(Vec3d(seen[i]) - mean)/size : 1;
            for (int c = 0; c < 3; c++)
                rows(i, c*found.dimension + k) = rays[i][c]*p;
        }
    found.R = QR(rows).R();
    return true;
}

//! The eigenvalue itself would be no smaller than what rounding leaves of the largest; the length that its vector leaves is.
double squaresAt(const Vec3d& normal, const std::vector<ViewRows>& views)
{
    const Matx33d across = turnToZ(normal);     // its first two rows
    double sum = 0;
    for (const ViewRows& view : views)
    {
        const int n = view.dimension;
        Eigen::MatrixXd B = Eigen::MatrixXd::Zero(3*n, 2*n);
        for (int c = 0; c < 3; c++)
            for (int i = 0; i < 2; i++)
                B.block(c*n, i*n, n, n).diagonal().setConstant(across(i, c));
        const Eigen::MatrixXd A = product(view.R, B);
        sum += timesVector(A, SymmetricEigen(transposeTimes(A, A)).vectors.col(0)).squaredNorm();
    }
    return sum;
}

struct Candidate
{
    double squares;
    Vec3d normal;
    bool operator<(const Candidate& other) const { return squares < other.squares; }
};

//! Downhill, until steps are smaller than so many radians.
Candidate descend(Candidate at, double step, double smallest, const std::vector<ViewRows>& views)
{
    while (step > smallest)
    {
        const Matx33d back = turnToZ(at.normal).t();
        Candidate best = at;
        for (int x = -1; x <= 1; x++)
            for (int y = -1; y <= 1; y++)
            {
                const Vec3d tried = normalize(back*Vec3d(step*x, step*y, 1));
                if ((x || y) && tried[2] > 0)
                    best = std::min(best, Candidate{ squaresAt(tried, views), tried });
            }
        if (!(best < at))
            step *= 0.5;
        at = best;
    }
    return at;
}

Vec3d normalAt(double tilt, double azimuth)
{
    return Vec3d(std::sin(tilt)*std::cos(azimuth), std::sin(tilt)*std::sin(azimuth), std::cos(tilt));
}

//! Of all normals of a tilt the best. @param step radians between those that are tried first
Candidate bestOfTilt(double tilt, double step, const std::vector<ViewRows>& views)
{
    const int count = cvCeil(2*CV_PI*std::sin(tilt)/step), HALVINGS = 4;
    double azimuth = 0, apart = 2*CV_PI/count;
    Candidate best = { DBL_MAX, Vec3d() };
    const auto look = [&](double at)
    {
        const Candidate tried = { squaresAt(normalAt(tilt, at), views), normalAt(tilt, at) };
        if (!(tried < best))
            return;
        best = tried;
        azimuth = at;
    };
    for (int i = 0; i < count; i++)
        look(i*apart);
    for (int i = 0; i < HALVINGS; i++)
    {
        apart *= 0.5;
        const double middle = azimuth;
        look(middle - apart);
        look(middle + apart);
    }
    return best;
}

} // namespace

std::vector<Vec3d> normalsByCoplanarity(const Camera& camera, const RigViews& views)
{
    const double STEP = 0.1, TILTS = 0.15, STEEPEST = 1.1, SMALLEST = 1e-6;     // radians
    const size_t MOST = 3;
    std::vector<ViewRows> rows;
    int freedom = -2;
    for (int view = 0; view < views.count(); view++)
    {
        ViewRows of;
        if (!findRows(camera, views.object[view], views.cameras[0].refracted[view], of))
            continue;
        rows.push_back(of);
        freedom += of.freedom;
    }
    std::vector<Vec3d> normals;
    if (rows.empty())
        return normals;
    std::vector<Candidate> candidates;
    for (double tilt = TILTS; tilt < STEEPEST; tilt += TILTS)
        candidates.push_back(bestOfTilt(tilt, STEP, rows));
    std::sort(candidates.begin(), candidates.end());
    const Candidate best = descend(candidates[0], STEP/2, SMALLEST, rows);
    normals.push_back(best.normal);
    // Where rays are bent by little, the azimuth shows and the tilt hardly.
    for (const Candidate& other : candidates)
        if (normals.size() < MOST && other.normal.dot(best.normal) < std::cos(TILTS/2) &&
            (other.squares - best.squares)*freedom < PLAUSIBLE*PLAUSIBLE*best.squares)
            normals.push_back(other.normal);
    return normals;
}

}} // namespace
