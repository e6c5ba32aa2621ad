// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "stereo/virtual_centres.hpp"
#include "math/rotation.hpp"
#include "points/plane.hpp"
#include <numeric>

namespace cv { namespace refract {

double paraxialTau(const Camera& camera)
{
    const Vec3d n = camera.layers().normal();
    Rays rays;
    uchar status = REFRACT_OK;
    rays.tau[0] = 0;
    camera.layers().traceOut(1, &n[0], &n[1], &n[2], rays, &status);
    return rays.tau[0];
}

double paraxialMagnification(const Camera& camera)
{
    const double SMALL = 1e-4;
    const Vec3d n = camera.layers().normal(), across(tangents(n).col(0).val);
    const Vec3d w[] = { normalize(n + SMALL*across), normalize(n - SMALL*across) };
    const double x[] = { w[0][0], w[1][0] }, y[] = { w[0][1], w[1][1] }, z[] = { w[0][2], w[1][2] };
    Rays rays;
    uchar status[] = { REFRACT_OK, REFRACT_OK };
    camera.layers().traceOut(2, x, y, z, rays, status);
    return norm(w[0] - w[1])/norm(rays.direction(0) - rays.direction(1));
}

Vec2d virtualCentreRange(const Camera& camera)
{
    const int STEPS = 32;
    const double RARE = 0.1;            // of the rays on either side: those along the window may meet its axis anywhere
    const double NEAR = 0.1;            // of how deep the window is, beside a range that is a point
    const std::vector<double>& lens = camera.lens().parameters();
    const Size known = camera.imageSize();      // else its middle is at the principal point
    const Size2d size = known.empty() ? Size2d(2*lens[2], 2*lens[3]) : Size2d(known);
    std::vector<double> taus;
    for (int row = 0; row <= STEPS; row++)
    {
        double u[STEPS + 1], v[STEPS + 1];
        Rays rays;
        uchar status[STEPS + 1] = {};
        for (int i = 0; i <= STEPS; i++)
        {
            u[i] = size.width*i/STEPS;
            v[i] = size.height*row/STEPS;
        }
        camera.unproject(STEPS + 1, u, v, rays, status);
        for (int i = 0; i <= STEPS; i++)
            if (status[i] == REFRACT_OK)
                taus.push_back(rays.tau[i]);
    }
    std::sort(taus.begin(), taus.end());
    const double paraxial = paraxialTau(camera);
    const size_t rare = (size_t)(RARE*taus.size());
    const Vec2d range = taus.empty() ? Vec2d::all(paraxial) : Vec2d(std::min(paraxial, taus[rare]),
                                                                    std::max(paraxial, taus[taus.size() - 1 - rare]));
    const double again = range[1] - range[0] + NEAR*camera.layers().stack().total;
    return range + Vec2d(-again, again);
}

VirtualPair::VirtualPair(const StereoPair& pair, const Vec2d& tau)
{
    const Vec3d V1 = tau[0]*pair.camera1.layers().normal(), V2 = tau[1]*pair.camera2.layers().normal();
    const Vec3d translation = pair.T + pair.R*V1 - V2;
    const double length = norm(translation);
    if (!(length > 0))
        CV_Error_(Error::StsBadArg, ("T is (%g, %g, %g): both cameras have the same centre of projection", pair.T[0],
                                     pair.T[1], pair.T[2]));
    const Matx33d K(100, 0, 50, 0, 100, 50, 0, 0, 1);       // of no effect on the rotations
    Mat r1, r2, p1, p2, Q;
    stereoRectify(K, noArray(), K, noArray(), Size(101, 101), pair.R, translation/length, r1, r2, p1, p2, Q);
    R1 = r1;
    R2 = r2;
    axis = p2.at<double>(0, 3) != 0 ? 0 : 1;
    centre1 = R1*V1;
    centre2 = R2*(V2 - pair.T);
    for (int i = 0; i < 3; i++)
        if (i != axis)
            centre2[i] = centre1[i];        // but for rounding
}

RowSamples::RowSamples(const StereoPair& pair, Size imageSize, const Vec2d& depthRange) : pair_(pair)
{
    const int COLUMNS = 20, ROWS = 15, DEPTHS = 8;
    const Camera& first = pair.camera1;
    const Camera& second = pair.camera2;
    const Matx33d R = pair.R;
    for (int row = 0; row < ROWS; row++)
        for (int k = 0; k < DEPTHS; k++)
        {
            Rays seen;
            double u[COLUMNS], v[COLUMNS], planeD[COLUMNS];
            double x[COLUMNS], y[COLUMNS], z[COLUMNS], w[COLUMNS], u2[COLUMNS], v2[COLUMNS];
            uchar status[COLUMNS] = {};
            const double part = k/(DEPTHS - 1.), depth = 1/((1 - part)/depthRange[0] + part/depthRange[1]);
            for (int i = 0; i < COLUMNS; i++)
            {
                u[i] = (imageSize.width - 1)*i/(COLUMNS - 1.);
                v[i] = (imageSize.height - 1)*row/(ROWS - 1.);
                planeD[i] = depth;
            }
            first.unproject(COLUMNS, u, v, seen, status);
            meetPlane(first.layers(), COLUMNS, Vec3d(0, 0, 1), planeD, seen, x, y, z, w, status);
            std::vector<Ray> rays;
            for (int i = 0; i < COLUMNS; i++)
            {
                rays.push_back({ seen.origin(i, first.layers().normal()), seen.direction(i) });
                const Vec3d X = R*Vec3d(x[i], y[i], z[i]) + w[i]*pair.T;
                x[i] = X[0]; y[i] = X[1]; z[i] = X[2];
            }
            second.project(COLUMNS, x, y, z, w, u2, v2, status);
            for (int i = 0; i < COLUMNS; i++)
                if (status[i] == REFRACT_OK && !(u2[i] >= 0 && v2[i] >= 0 && u2[i] <= imageSize.width - 1 && v2[i] <= imageSize.height - 1))
                    status[i] = REFRACT_NO_INTERSECTION;
            second.unproject(COLUMNS, u2, v2, seen, status);
            for (int i = 0; i < COLUMNS; i++)
                if (status[i] == REFRACT_OK)
                {
                    rays1_.push_back(rays[i]);
                    rays2_.push_back({ seen.origin(i, second.layers().normal()), seen.direction(i) });
                }
        }
    if (rays1_.empty())
        CV_Error_(Error::StsBadArg, ("depthRange is (%g, %g): the cameras have no common point in it%s",
                                     depthRange[0], depthRange[1],
                                     first.refracts() || second.refracts() ? " beyond their windows" : ""));
}

//! The row (column) in which the pinhole at the centre shows where a ray meets the plane z = depth; rectified frame.
static double rowOf(const Vec3d& origin, const Vec3d& direction, const Vec3d& centre, double depth, int row)
{
    const double s = (depth - origin[2])/direction[2];
    return s > 0 ? (origin[row] + s*direction[row] - centre[row])/(depth - centre[2]) : std::numeric_limits<double>::quiet_NaN();
}

std::vector<double> RowSamples::differences(const VirtualPair& v, double depth) const
{
    std::vector<double> result;
    result.reserve(rays1_.size());
    const int row = 1 - v.axis;
    for (size_t i = 0; i < rays1_.size(); i++)
        result.push_back(rowOf(v.R1*rays1_[i].origin, v.R1*rays1_[i].direction, v.centre1, depth, row) -
                         rowOf(v.R2*(rays2_[i].origin - pair_.T), v.R2*rays2_[i].direction, v.centre2, depth, row));
    return result;
}

namespace {

//! What the best centres make small, and its derivative by them.
class RowProblem
{
public:
    RowProblem(const StereoPair& pair, const RowSamples& samples, double depth) : pair_(pair), samples_(samples), depth_(depth)
    {
        const Camera* cameras[] = { &pair.camera1, &pair.camera2 };
        for (int k = 0; k < 2; k++)
        {
            free_[k] = cameras[k]->refracts();
            start_[k] = free_[k] ? paraxialTau(*cameras[k]) : 0;
            range_[k] = free_[k] ? virtualCentreRange(*cameras[k]) : Vec2d();
        }
    }
    Vec2d start() const { return start_; }
    Vec2d inRange(const Vec2d& tau) const
    {
        const auto limited = [&](int k) { return std::min(std::max(tau[k], range_[k][0]), range_[k][1]); };
        return Vec2d(limited(0), limited(1));
    }

    std::vector<double> residuals(const Vec2d& tau) const
    {
        const double STAY = 1e-3;       // a move of a centre counts this part of what it moves the image
        std::vector<double> e = samples_.differences(VirtualPair(pair_, tau), depth_);
        std::replace_if(e.begin(), e.end(), [](double x) { return std::isnan(x); }, 0.);
        const double weight = STAY*std::sqrt((double)e.size())/depth_;
        for (int k = 0; k < 2; k++)
            e.push_back(weight*(tau[k] - start_[k]));
        return e;
    }

    //! A Gauss-Newton step; a camera without window has its centre where it is.
    Vec2d step(const Vec2d& tau, const std::vector<double>& e) const
    {
        const double h = 1e-4*depth_;
        Matx22d A(free_[0] ? 0 : 1, 0, 0, free_[1] ? 0 : 1);
        std::vector<double> J[2];
        for (int k = 0; k < 2; k++)
        {
            J[k] = residuals(tau + h*Vec2d(k == 0, k == 1));
            for (size_t i = 0; i < e.size(); i++)
                J[k][i] = free_[k] ? (J[k][i] - e[i])/h : 0;
        }
        Vec2d g;
        for (size_t i = 0; i < e.size(); i++)
        {
            const Vec2d row(J[0][i], J[1][i]);
            A += row*row.t();
            g += row*e[i];
        }
        return -(A.inv()*g);
    }

private:
    const StereoPair& pair_;
    const RowSamples& samples_;
    double depth_;
    bool free_[2];
    Vec2d start_, range_[2];
};

double sumOfSquares(const std::vector<double>& e) { return std::inner_product(e.begin(), e.end(), e.begin(), 0.); }

} // namespace

Vec2d bestVirtualCentres(const StereoPair& pair, const RowSamples& samples, double depth)
{
    const int ITERATIONS = 20;
    const double DONE = 1e-9;       // relative, of the sum
    const RowProblem problem(pair, samples, depth);
    Vec2d tau = problem.start();
    std::vector<double> e = problem.residuals(tau);
    for (int iteration = 0; iteration < ITERATIONS; iteration++)
    {
        const Vec2d next = problem.inRange(tau + problem.step(tau, e));
        const std::vector<double> eNext = problem.residuals(next);
        if (!(sumOfSquares(eNext) < (1 - DONE)*sumOfSquares(e)))
            break;
        tau = next;
        e = eNext;
    }
    return tau;
}

}} // namespace
