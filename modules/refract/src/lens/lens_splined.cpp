// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/plane_lens.hpp"
#include "lens/spline_surface.hpp"
#include "lens/stereographic.hpp"
#include "math/missing.hpp"

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

SplineGrid gridOf(const String& model, const std::vector<double>& values)
{
    const int MOST = 65535;
    for (double value : values)
        if (value != std::floor(value) || !(value >= 1 && value <= MOST))
            CV_Error_(Error::StsBadArg, ("lensModel is %s; %g is not a whole number from 1 to %d", model.c_str(), value, MOST));
    const SplineGrid grid = { (int)values[0], (int)values[1], (int)values[2], values[3] };
    if ((grid.order != 2 && grid.order != 3) || grid.nx <= grid.order || grid.ny <= grid.order || grid.fovX >= 360)
        CV_Error_(Error::StsBadArg, ("lensModel is %s; its order must be 2 or 3, Nx and Ny above it, fov_x_deg below 360",
                                     model.c_str()));
    return grid;
}

class SplinedLens : public PlaneLens
{
public:
    SplinedLens(const String& model, const std::vector<double>& four, const Ptr<const SplineSurface>& surface)
        : PlaneLens(model, four), surface_(surface), m_(surface->model(fx_, fy_, cx_, cy_)) {}
    void project(int n, const double* x, const double* y, const double* z, double* u, double* v, uchar* status) const CV_OVERRIDE;
    Mat distCoeffs() const CV_OVERRIDE { return surface_->controls(); }
    bool isFixed(int) const CV_OVERRIDE { return true; }    // without the control points the others move the wrong way
    bool isSmooth() const CV_OVERRIDE { return surface_->grid().order > 2; }
    int controlsPerPixel() const CV_OVERRIDE { return (surface_->grid().order + 1)*(surface_->grid().order + 1); }
    void controlsOf(const Vec3d& d, int* which, double* weights) const CV_OVERRIDE;
    Ptr<Lens> withParameters(const std::vector<double>& p) const CV_OVERRIDE
    {
        return makePtr<SplinedLens>(model_, p, surface_);
    }

private:
    uchar bend(const Vec3d& d, Vec2d& plane, Matx23d* byDirection, Vec2d* byCoefficients) const CV_OVERRIDE;
    uchar unbend(const Vec2d& plane, Vec3d& d) const CV_OVERRIDE;

    const Ptr<const SplineSurface> surface_;
    const SplineModel m_;
};

void SplinedLens::project(int n, const double* x, const double* y, const double* z, double* u, double* v, uchar* status) const
{
    if (!splineKernels().project(m_, n, x, y, z, u, v))
        answerMissing(n, u, status, [=](int i) { return projectOne(Vec3d(x[i], y[i], z[i]), u[i], v[i]); });
}

uchar SplinedLens::bend(const Vec3d& d, Vec2d& plane, Matx23d* byDirection, Vec2d*) const
{
    Vec2d p;
    Matx22d slope;
    const uchar status = stereographic(d, p, byDirection);
    if (status != REFRACT_OK || !surface_->inRectangle(p))
        return REFRACT_OUTSIDE_LENS_MODEL;
    if (!byDirection && surface_->inDomain(p))
    {
        plane = surface_->at(p, nullptr);
        return REFRACT_OK;
    }
    plane = surface_->at(p, &slope);
    if (byDirection)
        *byDirection = slope**byDirection;
    return surface_->inDomain(p, slope) ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
}

void SplinedLens::controlsOf(const Vec3d& d, int* which, double* weights) const
{
    Vec2d p;
    stereographic(d, p, nullptr);
    surface_->weigh(p, which, weights);
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

Ptr<Lens> makeSplinedLens(const LensSpec& spec)
{
    const SplineGrid grid = gridOf(spec.model, spec.inName);
    spec.requireCount({ 2*(size_t)grid.nx*grid.ny });
    spec.requireNoSkew();
    std::vector<double> four = spec.parameters();
    four.resize(4);
    return makePtr<SplinedLens>(spec.model, four, makePtr<SplineSurface>(grid, spec.distCoeffs));
}

}} // namespace
