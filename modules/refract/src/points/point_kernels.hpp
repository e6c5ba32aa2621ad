// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_POINT_KERNELS_HPP
#define OPENCV_REFRACT_POINT_KERNELS_HPP

#include "window/layer_kernels.hpp"

/* Transforms, planes, curves, maps and triangulation of many points at once. No OpenCV in here, see dispatch/kernels.hpp. */

namespace cv { namespace refract {

//! Nodes of a tile of a map, in each direction.
enum { NODES = 8 };

/** A tile of a map whose pixels have depths of their own, as a polynomial of s = (1/(planeD - atCentre) - middle) scale, -1 ... 1:
raw pixel = sum over k of [k] s^k, of which each is given at the tile's nodes. */
struct SurfaceTile
{
    double u[3][NODES*NODES], v[3][NODES*NODES];
    double atCentre, middle, scale;
};

//! Rays of one camera, directions and axis in the frame of camera 1: origin = tau axis + centre.
struct CameraRays
{
    const double* seen;         //!< NaN: there is no ray
    const double *tau, *dx, *dy, *dz;
    double axis[3], centre[3];
};

//! Pixels of one camera.
struct CameraErrors
{
    const double* R;            //!< rotation from the frame of camera 1; null: none
    Columns observed;           //!< 2x1; NaN: not seen
    Columns predicted;          //!< 2x1
    Columns byPoint;            //!< derivatives of the predicted pixels, in the frame of the camera
};

//! What the calls on points ask for, of blocks of them.
struct PointKernels
{
    //! In place: X -> R X + t, R row-major.
    void (*transform)(const double* R, const double* t, int n, double* x, double* y, double* z);
    //! (x, y, z) = factor v
    void (*multiples)(const double* v, int n, const double* factor, double* x, double* y, double* z);
    //! X -> (x, y) = H X, dehomogenised; no answer unless axis.X > 0.
    bool (*pinhole)(const double* H, const double* axis, int n, const double* x, const double* y, const double* z,
                    double* u, double* v);
    //! See meetPlane; plane (a, b, c) and d of each lane.
    bool (*meetPlane)(const Stack& stack, const double* abc, const double* planeD, int n, const double* tau,
                      const double* dx, const double* dy, const double* dz, double* x, double* y, double* z, double* mu);

    //! Of each of n pixels between others, n + 2 in all: the square root of its distance from its neighbours' chord.
    void (*chordRoots)(int n, const double* u, const double* v, double* roots);
    /** Whether the chord of each of n segments of a curve (n + 1 ends) is within the tolerance of it. Its distance across the
    chord is about (1 - p^2) (middle + skew p), -1 <= p <= 1 by t: the middle and the next one tell (n + 1 middles); and at
    most middle + skew^2/(4 middle) and middle + 0.385 skew.
    @param slack what is left of the tolerance; no answer where the chord is not close, or the middle is NaN */
    bool (*areClose)(int n, double tolerance, const double* t, const double* u, const double* v, const double* tMiddle,
                     const double* uMiddle, const double* vMiddle, double* slack);
    //! Two rows by the point -> the one column of each by the parameter of A, whose point moves by A X.
    void (*chainLinear)(const double* A, int n, const double* x, const double* y, const double* z, const Columns& byPoint,
                        const Columns& out);
    //! out[i] = sum over r, c of row[r] values[NODES r + c] columns[n c + i]
    void (*interpolate)(const double* values, const double* row, const double* columns, int n, double* out);
    //! The raw pixels of n places of a row of a tile, at their depths; row and columns as interpolate's.
    void (*interpolateSurface)(const SurfaceTile& tile, const double* row, const double* columns, const double* planeD, int n,
                               double* u, double* v);
    /** The points with the least squared distance from the rays of two or more cameras.
    @param apart below about 1e-24 all rays are parallel; of two, half the square of the sine between them
    @param nearest how far along its ray the camera sees the point that has it least far */
    void (*meetRays)(int n, int cameras, const CameraRays* rays, double* x, double* y, double* z, double* apart,
                     double* nearest);
    /** One Gauss-Newton step of points (in the frame of camera 1) towards least squared pixel errors in all images.
    @param moved square of the pixels that the step moves the predictions */
    void (*gaussNewton)(int n, int cameras, const CameraErrors* errors, double* x, double* y, double* z, double* moved);
};

const PointKernels& pointKernels();

}} // namespace

#endif // OPENCV_REFRACT_POINT_KERNELS_HPP
