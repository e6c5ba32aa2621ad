// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/plane_lens.hpp"
#include "lens/stereographic.hpp"
#include "math/once.hpp"

/* mrcal's LENSMODEL_SPLINED_STEREOGRAPHIC_order=O_Nx=N_Ny=M_fov_x_deg=F: the stereographic projection and, added to it, a
uniform B-spline surface of degree O (2 or 3) over its plane, for a and b each:

    (a, b) = p + sum_ij B(gx - i) B(gy - j) c_ij,  p = stereographic(d)
    g = k p + ((N, M) - 1)/2,  k = (N - O)/(4 tan(F/4)) control points per unit

Control points come row by row, that of a and that of b together.

Domain: where all (O + 1)^2 control points around g exist, and the surface does not fold back: its Jacobian's determinant is
positive. The control points are the model, as the number of coefficients is for others: only fx, fy, cx, cy are parameters. */

namespace cv { namespace refract {

namespace {

const int MOST_ORDER = 3;

//! The control points that a coordinate needs, and what they weigh.
struct Weights
{
    int first;
    double value[MOST_ORDER + 1], slope[MOST_ORDER + 1];        //!< slope: by g
};

Weights weightsAt(double g, int order, int count)
{
    const double shift = order == 3 ? 0 : 0.5;
    const int cell = std::max(1, std::min((int)std::floor(g + shift), count - order));
    const double t = g - cell;
    if (order == 3)
    {
        const double r = 1 - t;
        return { cell - 1, { r*r*r/6, (4 + t*t*(3*t - 6))/6, (4 + r*r*(3*r - 6))/6, t*t*t/6 },
                 { -0.5*r*r, t*(1.5*t - 2), -r*(1.5*r - 2), 0.5*t*t } };
    }
    return { cell - 1, { 0.5*(0.5 - t)*(0.5 - t), 0.75 - t*t, 0.5*(0.5 + t)*(0.5 + t), 0 }, { t - 0.5, -2*t, t + 0.5, 0 } };
}

class SplinedLens : public PlaneLens
{
public:
    SplinedLens(const String& model, const std::vector<double>& intrinsics, const SplineGrid& grid);
    Mat distCoeffs() const CV_OVERRIDE { return Mat(controls_, true); }
    bool isFixed(int) const CV_OVERRIDE { return true; }    // without the control points the others move the wrong way
    Ptr<Lens> withParameters(const std::vector<double>& p) const CV_OVERRIDE;

private:
    //! Where the search for a direction may begin: a point of the stereographic plane and where it is seen.
    struct Start { Vec2d at, seen; };

    uchar bend(const Vec3d& d, Vec2d& plane, Matx23d* byDirection, Vec2d* byCoefficients) const CV_OVERRIDE;
    uchar unbend(const Vec2d& plane, Vec3d& d) const CV_OVERRIDE;
    Vec2d surface(const Vec2d& p, Matx22d& slope) const;
    bool isInside(const Vec2d& p) const { return std::abs(p[0]) <= edge_[0] && std::abs(p[1]) <= edge_[1]; }
    Vec2d intoDomain(const Vec2d& p) const;
    bool search(const Vec2d& target, Vec2d& p) const;
    void fillStarts() const;

    const SplineGrid grid_;
    const std::vector<double> controls_;
    double perUnit_;
    Vec2d edge_;
    mutable std::vector<Start> starts_;
    mutable Once fillStartsOnce_;
};

SplinedLens::SplinedLens(const String& model, const std::vector<double>& p, const SplineGrid& grid)
    : PlaneLens(model, std::vector<double>(p.begin(), p.begin() + 4)), grid_(grid), controls_(p.begin() + 4, p.end())
{
    perUnit_ = (grid.nx - grid.order)/(4*std::tan(grid.fovX*CV_PI/720));
    edge_ = Vec2d(grid.nx - grid.order, grid.ny - grid.order)*(0.5/perUnit_);
}

Vec2d SplinedLens::surface(const Vec2d& p, Matx22d& slope) const
{
    const int n = grid_.order + 1;
    const Weights x = weightsAt(p[0]*perUnit_ + 0.5*(grid_.nx - 1), grid_.order, grid_.nx);
    const Weights y = weightsAt(p[1]*perUnit_ + 0.5*(grid_.ny - 1), grid_.order, grid_.ny);
    Vec2d sum, byX, byY;
    for (int j = 0; j < n; j++)
    {
        const double* c = &controls_[2*((size_t)(y.first + j)*grid_.nx + x.first)];
        Vec2d row, rowByX;
        for (int i = 0; i < n; i++, c += 2)
        {
            row += x.value[i]*Vec2d(c);
            rowByX += x.slope[i]*Vec2d(c);
        }
        sum += y.value[j]*row;
        byX += y.value[j]*rowByX;
        byY += y.slope[j]*row;
    }
    slope = Matx22d(1 + perUnit_*byX[0], perUnit_*byY[0], perUnit_*byX[1], 1 + perUnit_*byY[1]);
    return p + sum;
}

uchar SplinedLens::bend(const Vec3d& d, Vec2d& plane, Matx23d* byDirection, Vec2d*) const
{
    Vec2d p;
    Matx22d slope;
    const uchar status = stereographic(d, p, byDirection);
    if (status != REFRACT_OK || !isInside(p))
        return REFRACT_OUTSIDE_LENS_MODEL;
    plane = surface(p, slope);
    if (byDirection)
        *byDirection = slope**byDirection;
    return determinant(slope) > 0 ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
}

Vec2d SplinedLens::intoDomain(const Vec2d& p) const
{
    return Vec2d(std::max(-edge_[0], std::min(p[0], edge_[0])), std::max(-edge_[1], std::min(p[1], edge_[1])));
}

//! Newton from p, along the edge of the domain where a step leads out of it; each step comes nearer.
bool SplinedLens::search(const Vec2d& target, Vec2d& p) const
{
    const double floor = 4*DBL_EPSILON*(1 + norm(target));
    Matx22d slope, slopeNext;
    Vec2d error = surface(p, slope) - target;
    for (int i = 0; i < 100; i++)
    {
        const double size = norm(error), determinant = cv::determinant(slope);
        if (!(determinant > 0))
            return false;
        const Vec2d step(-(slope(1, 1)*error[0] - slope(0, 1)*error[1])/determinant,
                         -(slope(0, 0)*error[1] - slope(1, 0)*error[0])/determinant);
        Vec2d next, errorNext;
        bool isNearer = false;
        for (double part = 1; part > 1e-6 && !isNearer; part *= 0.5)
        {
            next = intoDomain(p + part*step);
            errorNext = surface(next, slopeNext) - target;
            isNearer = norm(errorNext) < size && cv::determinant(slopeNext) > 0;
        }
        if (!isNearer)
            return size <= 1e3*floor;       // rounding has taken over, or there is nothing here
        p = next;
        error = errorNext;
        slope = slopeNext;
        if (norm(error) == 0)
            return true;
    }
    return norm(error) <= 1e3*floor;
}

//! Two points to a control point's distance: the surface bends no faster.
void SplinedLens::fillStarts() const
{
    const int nx = 2*(grid_.nx - grid_.order), ny = 2*(grid_.ny - grid_.order);
    Matx22d slope;
    for (int j = 0; j <= ny; j++)
        for (int i = 0; i <= nx; i++)
        {
            const Vec2d at((2.*i/nx - 1)*edge_[0], (2.*j/ny - 1)*edge_[1]), seen = surface(at, slope);
            if (determinant(slope) > 0)
                starts_.push_back({ at, seen });
        }
}

uchar SplinedLens::unbend(const Vec2d& plane, Vec3d& d) const
{
    Vec2d p = intoDomain(plane);
    if (!search(plane, p))
    {
        fillStartsOnce_([this] { fillStarts(); });
        const auto nearest = std::min_element(starts_.begin(), starts_.end(), [&](const Start& one, const Start& other)
        { return norm(one.seen - plane) < norm(other.seen - plane); });
        if (nearest == starts_.end())
            return REFRACT_OUTSIDE_LENS_MODEL;
        p = nearest->at;
        if (!search(plane, p))
            return REFRACT_OUTSIDE_LENS_MODEL;
    }
    d = stereographicDirection(p);
    return REFRACT_OK;
}

Ptr<Lens> SplinedLens::withParameters(const std::vector<double>& p) const
{
    std::vector<double> intrinsics = p;
    intrinsics.insert(intrinsics.end(), controls_.begin(), controls_.end());
    return makeSplinedLens(model_, intrinsics, grid_);
}

} // namespace

Ptr<Lens> makeSplinedLens(const String& model, const std::vector<double>& intrinsics, const SplineGrid& grid)
{
    return makePtr<SplinedLens>(model, intrinsics, grid);
}

}} // namespace
