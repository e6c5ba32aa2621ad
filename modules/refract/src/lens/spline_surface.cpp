// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/spline_surface.hpp"
#include "lens/one_to_one.hpp"
#include <array>

namespace cv { namespace refract {

namespace {

//! Cells to a control point's distance in which the surface is looked at for folds; searches begin at every STARTS-th.
const int CELLS = 8, STARTS = 2;

//! The control points that a coordinate needs, what they weigh, and by how much that changes.
template<int ORDER> struct Weights
{
    Weights(double g, int count) : first(splineCell<ORDER>(g, count) - 1)
    {
        const double t = g - (first + 1);
        splineWeights<ORDER>(t, value);
        slopes(t, 1 - t);
    }

    const int first;
    double value[ORDER + 1], slope[ORDER + 1];      //!< slope: by g

private:
    void slopes(double t, double r);
};

template<> inline void Weights<2>::slopes(double t, double)
{
    slope[0] = t - 0.5;
    slope[1] = -2*t;
    slope[2] = t + 0.5;
}

template<> inline void Weights<3>::slopes(double t, double r)
{
    slope[0] = -0.5*r*r;
    slope[1] = t*(1.5*t - 2);
    slope[2] = -r*(1.5*r - 2);
    slope[3] = 0.5*t*t;
}

} // namespace

SplineSurface::SplineSurface(const SplineGrid& grid, const std::vector<double>& controls)
    : grid_(grid), controls_(controls), perUnit_((grid.nx - grid.order)/(4*std::tan(grid.fovX*CV_PI/720))),
      edge_(Vec2d(grid.nx - grid.order, grid.ny - grid.order)*(0.5/perUnit_)),
      isMonotone_(isMonotone(Rect(0, 0, grid.nx, grid.ny)))
{
    if (!isMonotone_)
        findDomain();
    controls_.resize(controls_.size() + 2, 0.);
}

SplineModel SplineSurface::model(double fx, double fy, double cx, double cy) const
{
    return { fx, fy, cx, cy, grid_.order, grid_.nx, grid_.ny, perUnit_, { edge_[0], edge_[1] }, controls_.data(),
             isMonotone_ ? nullptr : domain_.ptr(), domain_.cols, domain_.rows, CELLS*perUnit_ };
}

Point SplineSurface::cellAt(const Vec2d& p) const
{
    return Point(std::min((int)((p[0] + edge_[0])*(CELLS*perUnit_)), domain_.cols - 1),
                 std::min((int)((p[1] + edge_[1])*(CELLS*perUnit_)), domain_.rows - 1));
}

bool SplineSurface::inDomain(const Vec2d& p, const Matx22d& slope) const
{
    return determinant(slope) > 0 && (isMonotone_ || domain_(cellAt(p)));
}

/* A spline's slope is a mean of the differences of its control points. Where the symmetric part of the Jacobian is positive
definite all over a rectangle, no two points of it have one image, and the determinant is positive. */
bool SplineSurface::isMonotone(const Rect& controls) const
{
    double least[2] = { 0, 0 }, across[2] = { 0, 0 };
    for (int j = controls.y; j < controls.br().y; j++)
        for (int i = controls.x; i < controls.br().x; i++)
            for (int axis = 0; axis < 2; axis++)
            {
                const bool isLast = axis == 0 ? i + 1 == controls.br().x : j + 1 == controls.br().y;
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
    const int nx = CELLS*(grid_.nx - grid_.order), ny = CELLS*(grid_.ny - grid_.order);
    const auto corner = [&](int i, int j) { return Vec2d((2.*i/nx - 1)*edge_[0], (2.*j/ny - 1)*edge_[1]); };
    Mat1b isRegular(ny + 1, nx + 1);
    Mat2d seen(ny + 1, nx + 1);
    Matx22d slope;
    for (int j = 0; j <= ny; j++)
        for (int i = 0; i <= nx; i++)
        {
            seen(j, i) = at(corner(i, j), &slope);
            isRegular(j, i) = determinant(slope) > 0;
        }
    domain_ = oneToOneCells(seen, isRegular);
    markCertain();
    for (int j = STARTS/2; j < ny; j += STARTS)
        for (int i = STARTS/2; i < nx; i += STARTS)
            if (domain_(j, i))
                starts_.push_back({ corner(i, j), seen(j, i) });
}

//! Cells whose control points leave no doubt of the slope.
void SplineSurface::markCertain()
{
    const int n = grid_.order + 1;
    for (int j = 0; j < domain_.rows; j++)
        for (int i = 0; i < domain_.cols; i++)
            if (domain_(j, i) && isMonotone(Rect(i/CELLS, j/CELLS, n, n)))
                domain_(j, i) = CERTAIN;
}

/* What is added to the plane, and its derivatives by g. All that decides the form of the loops is constant, so that
straight code comes of them. */
template<int ORDER, bool WITH_SLOPE>
Vec2d SplineSurface::added(const Vec2d& g, Vec2d& byX, Vec2d& byY) const
{
    const Weights<ORDER> x(g[0], grid_.nx), y(g[1], grid_.ny);
    const double* c = &controls_[2*((size_t)y.first*grid_.nx + x.first)];
    double sum[2] = { 0, 0 }, sumByX[2] = { 0, 0 }, sumByY[2] = { 0, 0 };
    for (int j = 0; j <= ORDER; j++, c += 2*(size_t)grid_.nx)
    {
        double row[2] = { 0, 0 }, rowByX[2] = { 0, 0 };
        for (int i = 0; i <= ORDER; i++)
            for (int k = 0; k < 2; k++)
            {
                row[k] += x.value[i]*c[2*i + k];
                if (WITH_SLOPE)
                    rowByX[k] += x.slope[i]*c[2*i + k];
            }
        for (int k = 0; k < 2; k++)
        {
            sum[k] += y.value[j]*row[k];
            if (WITH_SLOPE)
            {
                sumByX[k] += y.value[j]*rowByX[k];
                sumByY[k] += y.slope[j]*row[k];
            }
        }
    }
    byX = Vec2d(sumByX);
    byY = Vec2d(sumByY);
    return Vec2d(sum);
}

template<int ORDER> void SplineSurface::weigh(const Vec2d& g, int* which, double* weights) const
{
    const Weights<ORDER> x(g[0], grid_.nx), y(g[1], grid_.ny);
    for (int j = 0; j <= ORDER; j++)
        for (int i = 0; i <= ORDER; i++)
        {
            *which++ = (y.first + j)*grid_.nx + x.first + i;
            *weights++ = x.value[i]*y.value[j];
        }
}

void SplineSurface::weigh(const Vec2d& p, int* which, double* weights) const
{
    grid_.order == 3 ? weigh<3>(gridAt(p), which, weights) : weigh<2>(gridAt(p), which, weights);
}

Vec2d SplineSurface::at(const Vec2d& p, Matx22d* slope) const
{
    const Vec2d g = gridAt(p);
    Vec2d byX, byY;
    if (!slope)
        return p + (grid_.order == 3 ? added<3, false>(g, byX, byY) : added<2, false>(g, byX, byY));
    const Vec2d sum = grid_.order == 3 ? added<3, true>(g, byX, byY) : added<2, true>(g, byX, byY);
    *slope = Matx22d(1 + perUnit_*byX[0], perUnit_*byY[0], perUnit_*byX[1], 1 + perUnit_*byY[1]);
    return p + sum;
}

Vec2d SplineSurface::intoRectangle(const Vec2d& p) const
{
    return Vec2d(std::max(-edge_[0], std::min(p[0], edge_[0])), std::max(-edge_[1], std::min(p[1], edge_[1])));
}

//! Newton from p, along the edge of the rectangle where a step leads out of it. Each step comes nearer and stays in the domain.
bool SplineSurface::search(const Vec2d& target, Vec2d& p) const
{
    const double exact = DBL_EPSILON*(1 + norm(target)), enough = 4e3*exact;
    Matx22d slope, slopeNext;
    Vec2d error = at(p, &slope) - target;
    double size = norm(error);
    if (!inDomain(p, slope))
        return false;
    for (int i = 0; i < 100 && size > exact; i++)
    {
        const Vec2d step = (-1/determinant(slope))*Vec2d(slope(1, 1)*error[0] - slope(0, 1)*error[1],
                                                         slope(0, 0)*error[1] - slope(1, 0)*error[0]);
        bool isNearer = false;
        for (double part = 1; part > 1e-6 && !isNearer; part *= 0.5)
        {
            const Vec2d next = intoRectangle(p + part*step), errorNext = at(next, &slopeNext) - target;
            const double sizeNext = norm(errorNext);
            isNearer = sizeNext < size && inDomain(next, slopeNext);
            if (isNearer)
            {
                p = next;
                error = errorNext;
                size = sizeNext;
                slope = slopeNext;
            }
            else if (size <= enough)
                return true;            // rounding has taken over
        }
        if (!isNearer)
            return false;
    }
    return size <= enough;
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

}} // namespace
