// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LENS_HPP
#define OPENCV_REFRACT_LENS_HPP

#include "precomp.hpp"
#include "simd/columns.hpp"

namespace cv { namespace refract {

/* What a lens is: a one-to-one map between directions and pixels. It knows nothing of windows. models.hpp lists all models, and
says how to add one.

The kernels work on blocks of structure-of-arrays. A lane whose status is not REFRACT_OK on entry keeps its status. A
direction or pixel outside the range where the model is one-to-one becomes REFRACT_OUTSIDE_LENS_MODEL. */
class Lens
{
public:
    virtual ~Lens() {}

    //! Directions (any length) -> pixels.
    virtual void project(int n, const double* x, const double* y, const double* z,
                         double* u, double* v, uchar* status) const = 0;

    //! Pixels -> unit directions, to the accuracy of double.
    virtual void unproject(int n, const double* u, const double* v,
                           double* x, double* y, double* z, uchar* status) const = 0;

    //! project with derivatives: by the direction (2x3) and by parameters() (2 x count; may be null).
    virtual void projectJacobian(int n, const double* x, const double* y, const double* z, double* u, double* v,
                                 const Columns& byDirection, const Columns& byParameters, uchar* status) const = 0;
    virtual int parameterCount() const = 0;

    //! The same for one direction, matrices row-major.
    uchar projectJacobian(const Vec3d& d, Vec2d& pixel, double* dPixel_dDirection, double* dPixel_dParameters) const
    {
        uchar status = REFRACT_OK;
        const Columns byDirection = { dPixel_dDirection, 3, 1 }, byParameters = { dPixel_dParameters, parameterCount(), 1 };
        projectJacobian(1, &d[0], &d[1], &d[2], &pixel[0], &pixel[1], byDirection, byParameters, &status);
        return status;
    }

    virtual String model() const = 0;
    virtual Mat cameraMatrix() const = 0;
    virtual Mat distCoeffs() const = 0;

    //! fx, fy, cx, cy, coefficients as given.
    virtual std::vector<double> parameters() const = 0;
    //! What they are called, as in OpenCV's documentation; GLASS_FIX_K1 and so on go by it.
    virtual std::vector<String> parameterNames() const = 0;
    //! True for those that no calibration estimates.
    virtual bool isFixed(int /*parameter*/) const { return false; }
    //! False where the curvature of lines' images may jump.
    virtual bool isSmooth() const { return true; }
    //! Of a lens made of control points, how many of them a pixel depends on; 0: it is not such a lens.
    virtual int controlsPerPixel() const { return 0; }
    //! Which control points those are of a direction that has a pixel, and the plane's derivative by each (that of both
    //! coordinates, each by its own).
    virtual void controlsOf(const Vec3d& /*direction*/, int* /*which*/, double* /*weights*/) const {}
    //! The same model with other parameters.
    virtual Ptr<Lens> withParameters(const std::vector<double>& parameters) const = 0;
};

}} // namespace

#endif // OPENCV_REFRACT_LENS_HPP
