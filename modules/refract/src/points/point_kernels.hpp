// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_POINT_KERNELS_HPP
#define OPENCV_REFRACT_POINT_KERNELS_HPP

#include "window/layer_kernels.hpp"
#include "window/surface.hpp"

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

//! Rays of one camera, directions and axis in the frame of camera 1: origin = tau axis + offset + centre.
struct CameraRays
{
    const double* seen;         //!< NaN: there is no ray
    const double *tau, *dx, *dy, *dz;
    double axis[3], centre[3];
    Columns offset;             //!< three; may be null: 0
    Columns sheet;              //!< three: normals of sheets, of which the rays are part; NaN: only the ray. May be null: only rays
};

//! Pixels of one camera.
struct CameraErrors
{
    const double* R;            //!< rotation from the frame of camera 1; null: none
    Columns observed;           //!< 2x1; NaN: this coordinate was not seen
    Columns predicted;          //!< 2x1
    Columns byPoint;            //!< derivatives of the predicted pixels, in the frame of the camera
    Columns whitening;          //!< 3x1: W's uu, vu, vv; may be null: 1, 0, 1
};

//! Derivatives of one camera's pixels by the point; 0 where it is not seen.
struct PixelsByPoint
{
    const double* R;            //!< rotation from the frame of camera 1; null: none
    Columns byPoint;            //!< 2x3, in the frame of the camera
};

//! Derivatives of one camera's pixels by parameters, of which some are uncertain.
struct PixelsByParameters
{
    Columns values;             //!< two rows
    const int* which;           //!< columns of the uncertain ones
    int count;                  //!< how many they are
};

//! How rays of one camera become curves in the image of another, X' = R X + T.
struct CurveFrame
{
    double R[9], T[3];
    double normal[3];           //!< of the first camera's window, in its frame: a ray is tau normal + offset + s d
    Surface lastSurface;        //!< of that window, in the same frame; distance 0 without window
    bool isLimited;             //!< to depths, z from near to far
    double near, far;
};

//! The columns of curves: EpipolarCurve's members in the frame of the other camera, and the range of t.
enum { CURVE_DIRECTION = 0, CURVE_ORIGIN = 3, CURVE_UNIT = 6, CURVE_FAR = 7, CURVE_NEAR = 8, CURVE_COLUMNS = 9 };

//! Where a pixel and a curve are nearest, columns: the distance, its derivative by the pixel (2), how many pixels the last step
//! moved along the curve, whether an end of the curve stopped it (0 or 1).
enum { NEAREST_DISTANCE = 0, NEAREST_NORMAL = 1, NEAREST_MOVED = 3, NEAREST_AT_END = 4, NEAREST_COLUMNS = 5 };

//! How the points of a ray move in the frame of the other camera: by dRotation[k] (X - shift) and by dTranslation.
struct CurveMotion
{
    double R[9], dRotation[3][9], shift[3], dTranslation[9];
};

//! What the calls on points ask for, of blocks of them.
struct PointKernels
{
    //! In place: X -> R X + t, R row-major; whether no point is extreme then (moderate.hpp).
    bool (*transform)(const double* R, const double* t, int n, double* x, double* y, double* z);
    //! (x, y, z) = factor v
    void (*multiples)(const double* v, int n, const double* factor, double* x, double* y, double* z);
    //! X -> (x, y) = H X, dehomogenised; no answer unless axis.X > 0.
    bool (*pinhole)(const double* H, const double* axis, int n, const double* x, const double* y, const double* z,
                    double* u, double* v);
    //! See meetPlane; plane (a, b, c) and d of each lane.
    bool (*meetPlane)(const Stack& stack, const Surface& lastSurface, const double* abc, const double* planeD, int n,
                      const double* tau, const double* dx, const double* dy, const double* dz, double* x, double* y, double* z,
                      double* mu);
    //! The same for rays tau n + offset + s d.
    bool (*meetPlaneOffAxis)(const Stack& stack, const Surface& lastSurface, const Columns& offset, const double* abc,
                             const double* planeD, int n, const double* tau, const double* dx, const double* dy, const double* dz,
                             double* x, double* y, double* z, double* mu);

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
    /** The points with the least squared distance from the rays and sheets of two or more cameras.
    @param apart below about 1e-24 all rays are parallel; of two, half the square of the sine between them
    @param nearest how far along its ray the camera sees the point that has it least far */
    void (*meetRays)(int n, int cameras, const CameraRays* rays, double* x, double* y, double* z, double* apart,
                     double* nearest);
    /** One Gauss-Newton step of points (in the frame of camera 1) towards least squared pixel errors in all images.
    @param moved square of the pixels that the step moves the predictions */
    void (*gaussNewton)(int n, int cameras, const CameraErrors* errors, double* x, double* y, double* z, double* moved);

    /** E = A C B^T, the covariance of two cameras' pixels (2x2) from that of their parameters.
    @param C A.count x B.count, row by row; isSame: its lower triangle, half of the diagonal, 0 above it; E = A C A^T + its transpose */
    void (*carryCovariance)(int n, const PixelsByParameters& A, const PixelsByParameters& B, const double* C, bool isSame,
                            const Columns& E);
    /** Covariance of maximum-likelihood points, 3x3 in the frame of camera 1: J^+ (variance I + E) J^+^T; NaN where the pixels do
    not determine the point.
    @param E two rows and columns a camera; may be null
    @param byPixel scratch: 2*cameras x 3 */
    void (*pointCovariance)(int n, int cameras, const PixelsByPoint* pixels, double variance, const Columns& E,
                            const Columns& byPixel, const Columns& covariance);

    /** Rays -> curves; no answer (in CURVE_FAR) where a ray has no point in the range.
    @param offset of the rays' origins; may be null */
    bool (*curvesOf)(const CurveFrame& frame, int n, const double* tau, const Columns& offset, const double* dx, const double* dy,
                     const double* dz, const Columns& curves);
    //! The t at which a ray of the other camera, tau axis + offset + s d, comes nearest by angle; the middle where it is NaN.
    void (*nearestToRay)(const Columns& curves, const double* axis, int n, const double* tau, const Columns& offset,
                         const double* dx, const double* dy, const double* dz, double* t);
    //! The curves' points at t, in the frame of the other camera.
    void (*curvePoints)(const Columns& curves, int n, const double* t, double* x, double* y, double* z);
    /** One Gauss-Newton step of t towards the point of the curve that is nearest to the pixel. A step of less than `enough`
    pixels is not taken: the distance is that at t. All is NaN where there is no image.
    @param u, v, byPoint images of the curves' points, and their derivatives */
    void (*approachPixel)(const Columns& curves, double enough, int n, const double* pixelU, const double* pixelV,
                          const double* u, const double* v, const Columns& byPoint, double* t, const Columns& nearest);
    /** Derivatives of the distance.
    @param x, y, z, dx, dy, dz the nearest point and its ray, in the frame of the first camera
    @param mx, my, mz normal of the plane in which the point moves where an end stopped it, else the ray
    @param byPoint1, byPoint2 derivatives of its images, each in the frame of its camera
    @param out by the first camera's pixel (2), the other's (2), dRotation (3), dTranslation (3) */
    void (*distanceDerivatives)(const CurveMotion& motion, int n, const double* x, const double* y, const double* z,
                                const double* dx, const double* dy, const double* dz, const double* mx, const double* my,
                                const double* mz, const Columns& byPoint1, const Columns& byPoint2, const Columns& nearest,
                                const Columns& out);

    //! Unit normals of two directions each.
    void (*normals)(int n, const double* ax, const double* ay, const double* az, const double* bx, const double* by, const double* bz,
                    double* x, double* y, double* z);
    /** One step of Newton's method along rays to where a coordinate of a pixel is right.
    @param gradient of the predicted coordinate by the point, three columns
    @param s how far along each ray, in and out
    @param error squared, before the step
    @param sine squared, between ray and sheet */
    void (*slide)(int n, const double* observed, const double* predicted, const Columns& gradient, const double* dx, const double* dy,
                  const double* dz, double* s, double* error, double* sine);
};

const PointKernels& pointKernels();

}} // namespace

#endif // OPENCV_REFRACT_POINT_KERNELS_HPP
