// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LENS_HPP
#define OPENCV_REFRACT_LENS_HPP

#include "precomp.hpp"
#include "simd/columns.hpp"

namespace cv { namespace refract {

/* What a lens is: a one-to-one map between directions and pixels. It knows nothing of windows.

How to add one: derive from Lens in a lens_<model>.cpp of its own, state the formula and its domain of validity at the
top, add a make function below, name it in camera/create.cpp, and add it to the list of lenses in the tests (test/scenes.hpp),
which run the same battery over all models. With a vector form derive from KernelLens.

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

//! OpenCV's model with 0, 4, 5, 8, 12 or 14 coefficients.
Ptr<Lens> makeOpenCVLens(const Matx33d& cameraMatrix, const std::vector<double>& distCoeffs,
                         const String& model = "opencv");
//! cv::fisheye's model with 4 coefficients.
Ptr<Lens> makeFisheyeLens(const Matx33d& cameraMatrix, const std::vector<double>& distCoeffs);
//! mrcal's models by name.
Ptr<Lens> makeMrcalLens(const String& model, const std::vector<double>& intrinsics);

//! What makeMrcalLens makes of a name, its arguments checked: STEREOGRAPHIC, LONLAT, LATLON.
Ptr<Lens> makePanoramicLens(const String& model, const std::vector<double>& intrinsics);
//! CAHVOR (linearity 1) and CAHVORE, whose last three coefficients must be 0.
Ptr<Lens> makeCahvorLens(const String& model, const std::vector<double>& intrinsics, double linearity);

//! Control points of a spline surface over the stereographic plane, and the degrees across that it is for.
struct SplineGrid
{
    int order, nx, ny;
    double fovX;
};

//! SPLINED_STEREOGRAPHIC.
Ptr<Lens> makeSplinedLens(const String& model, const std::vector<double>& intrinsics, const SplineGrid& grid);

}} // namespace

#endif // OPENCV_REFRACT_LENS_HPP
