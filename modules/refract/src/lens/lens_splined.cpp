// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/one_to_one.hpp"
#include "lens/plane_lens.hpp"
#include "lens/stereographic.hpp"
#include <array>

/* mrcal's LENSMODEL_SPLINED_STEREOGRAPHIC_order=O_Nx=N_Ny=M_fov_x_deg=F: the stereographic projection and, added to it, a
uniform B-spline surface of degree O (2 or 3) over its plane, for a and b each:

    (a, b) = p + sum_ij B(gx - i) B(gy - j) c_ij,  p = stereographic(d)
    g = k p + ((N, M) - 1)/2,  k = (N - O)/(4 tan(F/4)) control points per unit

Control points come row by row, that of a and that of b together.

Domain: where all (O + 1)^2 control points around g exist and the surface does not fold back: all around, its Jacobian's
determinant is positive. Where mrcal saw no targets, surfaces do fold, and pixels there have several directions: the domain
ends before the second of them. The control points are the model, as the number of coefficients is for others: only fx, fy,
cx, cy are parameters. */

namespace cv { namespace refract {

namespace {

const int MOST_ORDER = 3;
//! Cells to a control point's distance in which the surface is looked at for folds; searches begin at every STARTS-th.
const int CELLS = 8, STARTS = 2;

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

//! The surface and its domain. What lenses that differ in fx, fy, cx, cy have in common.
class SplineSurface
{
public:
    SplineSurface(const SplineGrid& grid, const std::vector<double>& controls);
    const SplineGrid& grid() const { return grid_; }
    const std::vector<double>& controls() const { return controls_; }

    //! A point of the stereographic plane -> where it is seen, and by how much that moves.
    Vec2d at(const Vec2d& p, Matx22d& slope) const;
    bool inRectangle(const Vec2d& p) const { return std::abs(p[0]) <= edge_[0] && std::abs(p[1]) <= edge_[1]; }
    bool inDomain(const Vec2d& p, const Matx22d& slope) const;
    //! The point that is seen there; false if there is none.
    bool invert(const Vec2d& seen, Vec2d& p) const;

private:
    //! Where a search may begin: a point of the stereographic plane and where it is seen.
    struct Start { Vec2d at, seen; };

    Vec2d intoRectangle(const Vec2d& p) const;
    Point cellAt(const Vec2d& p) const;
    bool isMonotone() const;
    void findDomain();
    bool search(const Vec2d& target, Vec2d& p) const;

    const SplineGrid grid_;
    const std::vector<double> controls_;
    const double perUnit_;
    const Vec2d edge_;          //!< the rectangle in the stereographic plane, about 0
    Mat1b domain_;              //!< not 0 for its cells in the domain; empty: all of them
    std::vector<Start> starts_;
};

class SplinedLens : public PlaneLens
{
public:
    SplinedLens(const String& model, const std::vector<double>& four, const Ptr<const SplineSurface>& surface)
        : PlaneLens(model, four), surface_(surface) {}
    Mat distCoeffs() const CV_OVERRIDE { return columnOf(surface_->controls()); }
    bool isFixed(int) const CV_OVERRIDE { return true; }    // without the control points the others move the wrong way
    bool isSmooth() const CV_OVERRIDE { return surface_->grid().order > 2; }
    Ptr<Lens> withParameters(const std::vector<double>& p) const CV_OVERRIDE
    {
        return makePtr<SplinedLens>(model_, p, surface_);
    }

private:
    uchar bend(const Vec3d& d, Vec2d& plane, Matx23d* byDirection, Vec2d* byCoefficients) const CV_OVERRIDE;
    uchar unbend(const Vec2d& plane, Vec3d& d) const CV_OVERRIDE;

    const Ptr<const SplineSurface> surface_;
};

SplineSurface::SplineSurface(const SplineGrid& grid, const std::vector<double>& controls)
    : grid_(grid), controls_(controls), perUnit_((grid.nx - grid.order)/(4*std::tan(grid.fovX*CV_PI/720))),
      edge_(Vec2d(grid.nx - grid.order, grid.ny - grid.order)*(0.5/perUnit_))
{
    findDomain();
}

Point SplineSurface::cellAt(const Vec2d& p) const
{
    return Point(std::min((int)(0.5*(p[0]/edge_[0] + 1)*domain_.cols), domain_.cols - 1),
                 std::min((int)(0.5*(p[1]/edge_[1] + 1)*domain_.rows), domain_.rows - 1));
}

bool SplineSurface::inDomain(const Vec2d& p, const Matx22d& slope) const
{
    return (domain_.empty() || domain_(cellAt(p))) && determinant(slope) > 0;
}

/* A spline's slope is a mean of the differences of its control points. Where the symmetric part of the Jacobian is positive
definite all over the rectangle, no two points of it have one image. */
bool SplineSurface::isMonotone() const
{
    double least[2] = { 0, 0 }, across[2] = { 0, 0 };
    for (int j = 0; j < grid_.ny; j++)
        for (int i = 0; i < grid_.nx; i++)
            for (int axis = 0; axis < 2; axis++)
            {
                const bool isLast = axis == 0 ? i + 1 == grid_.nx : j + 1 == grid_.ny;
                const double* here = &controls_[2*((size_t)j*grid_.nx + i)];
                const double* next = here + (isLast ? 0 : axis == 0 ? 2 : 2*grid_.nx);
                least[axis] = std::min(least[axis], perUnit_*(next[axis] - here[axis]));
                across[axis] = std::max(across[axis], perUnit_*std::abs(next[1 - axis] - here[1 - axis]));
            }
    const double twist = 0.5*(across[0] + across[1]);
    return least[0] > -1 && (1 + least[0])*(1 + least[1]) > twist*twist;
}

void SplineSurface::findDomain()
{
    if (isMonotone())
        return;
    const int nx = CELLS*(grid_.nx - grid_.order), ny = CELLS*(grid_.ny - grid_.order);
    const auto corner = [&](int i, int j) { return Vec2d((2.*i/nx - 1)*edge_[0], (2.*j/ny - 1)*edge_[1]); };
    Mat1b isRegular(ny + 1, nx + 1);
    Mat2d seen(ny + 1, nx + 1);
    Matx22d slope;
    for (int j = 0; j <= ny; j++)
        for (int i = 0; i <= nx; i++)
        {
            seen(j, i) = at(corner(i, j), slope);
            isRegular(j, i) = determinant(slope) > 0;
        }
    domain_ = oneToOneCells(seen, isRegular);
    for (int j = STARTS/2; j < ny; j += STARTS)
        for (int i = STARTS/2; i < nx; i += STARTS)
            if (domain_(j, i))
                starts_.push_back({ corner(i, j), seen(j, i) });
}

Vec2d SplineSurface::at(const Vec2d& p, Matx22d& slope) const
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

Vec2d SplineSurface::intoRectangle(const Vec2d& p) const
{
    return Vec2d(std::max(-edge_[0], std::min(p[0], edge_[0])), std::max(-edge_[1], std::min(p[1], edge_[1])));
}

//! Newton from p, along the edge of the rectangle where a step leads out of it; each step comes nearer and stays in the domain.
bool SplineSurface::search(const Vec2d& target, Vec2d& p) const
{
    const double floor = 4*DBL_EPSILON*(1 + norm(target));
    Matx22d slope, slopeNext;
    Vec2d error = at(p, slope) - target;
    if (!inDomain(p, slope))
        return false;
    for (int i = 0; i < 100; i++)
    {
        const double size = norm(error), determinant = cv::determinant(slope);
        const Vec2d step(-(slope(1, 1)*error[0] - slope(0, 1)*error[1])/determinant,
                         -(slope(0, 0)*error[1] - slope(1, 0)*error[0])/determinant);
        Vec2d next, errorNext;
        bool isNearer = false;
        for (double part = 1; part > 1e-6 && !isNearer; part *= 0.5)
        {
            next = intoRectangle(p + part*step);
            errorNext = at(next, slopeNext) - target;
            isNearer = norm(errorNext) < size && inDomain(next, slopeNext);
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

//! From the stereographic projection's answer, else from what is seen nearest.
bool SplineSurface::invert(const Vec2d& seen, Vec2d& p) const
{
    const int TRIALS = 4;
    if (search(seen, p = intoRectangle(seen)))
        return true;
    std::array<Start, TRIALS> nearest;
    const auto end = std::partial_sort_copy(starts_.begin(), starts_.end(), nearest.begin(), nearest.end(),
        [&](const Start& one, const Start& other) { return norm(one.seen - seen) < norm(other.seen - seen); });
    for (auto start = nearest.begin(); start != end; start++)
        if (search(seen, p = start->at))
            return true;
    return false;
}

uchar SplinedLens::bend(const Vec3d& d, Vec2d& plane, Matx23d* byDirection, Vec2d*) const
{
    Vec2d p;
    Matx22d slope;
    const uchar status = stereographic(d, p, byDirection);
    if (status != REFRACT_OK || !surface_->inRectangle(p))
        return REFRACT_OUTSIDE_LENS_MODEL;
    plane = surface_->at(p, slope);
    if (byDirection)
        *byDirection = slope**byDirection;
    return surface_->inDomain(p, slope) ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
}

uchar SplinedLens::unbend(const Vec2d& plane, Vec3d& d) const
{
    Vec2d p;
    if (!surface_->invert(plane, p))
        return REFRACT_OUTSIDE_LENS_MODEL;
    d = stereographicDirection(p);
    return REFRACT_OK;
}

} // namespace

Ptr<Lens> makeSplinedLens(const String& model, const std::vector<double>& p, const SplineGrid& grid)
{
    const Ptr<const SplineSurface> surface = makePtr<SplineSurface>(grid, std::vector<double>(p.begin() + 4, p.end()));
    return makePtr<SplinedLens>(model, std::vector<double>(p.begin(), p.begin() + 4), surface);
}

}} // namespace
