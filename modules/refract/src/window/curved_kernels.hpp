// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CURVED_KERNELS_HPP
#define OPENCV_REFRACT_CURVED_KERNELS_HPP

#include "simd/columns.hpp"
#include "window/faces.hpp"

/* Tubes and bent panes as the kernels see them. No OpenCV in here, see dispatch/kernels.hpp. */

namespace cv { namespace refract {

/** One face, in the window's frame, with the camera at its origin: points with

    gradient.X + curvature/2 (x^2 + y^2 + third z^2) = distance,

where the left side's gradient is the unit normal, towards the scene. */
struct CurvedFace
{
    double gradient[3], distance, curvature;
    double after;                   //!< index of the medium behind it
    double excess;                  //!< after^2 - before^2
    double height;                  //!< bent: where it meets the axis along the window's normal
    double byCurvature;             //!< bent: its curvature by the first face's
};

//! All faces, the camera's first: cylinders about one axis, or spheres that are nearly a plane.
struct CurvedFaces
{
    double axes[9];                 //!< rows of the frame: a tube's axis is the third; a bent pane's are as of TiltedFaces
    double third;                   //!< of all faces: 0 cylinders, 1 spheres
    double normal[3];               //!< of rays, tau normal + offset, in the frame
    double center[3];               //!< of a tube, in the frame
    const CurvedFace* faces;
    const Face* tangents;           //!< bent: the planes that touch the faces on the axis
    int count;
    /** The least s from one face to the next. Faces that lean may intersect, so that light comes to them in another order: 0. All
    others only touch, where a thickness is 0, within rounding. */
    double least;
    double inner, outer;            //!< index of the camera's and the scene's medium
    WindowLayout at;                //!< columns of derivatives
};

//! Sine of the angle with a tube's axis up to which a direction is one along it, but for rounding: it never leaves.
const double ALONG_AXIS = 1e-12;

//! What Layers asks for, of blocks of points, where faces are curved.
struct CurvedKernels
{
    //! As LayerKernels' traceOut; the origin is tau n + offset (3 columns).
    bool (*traceOut)(const CurvedFaces& window, int n, const double* wx, const double* wy, const double* wz,
                     double* tau, const Columns& offset, double* dx, double* dy, double* dz);
    //! As LayerKernels' solveIn; dx, dy, dz come as directions to begin with.
    bool (*solveIn)(const CurvedFaces& window, int n, const double* x, const double* y, const double* z, const double* w,
                    double* dx, double* dy, double* dz);
    //! As LayerKernels' chainWindow, from the directions that solveIn gave; two or three rows.
    void (*chain)(const CurvedFaces& window, int rows, int n, const double* x, const double* y, const double* z,
                  const double* dx, const double* dy, const double* dz, const Columns& byDirection, const Columns& byPoint,
                  const Columns& byWindow);
};

const CurvedKernels& curvedKernels();

}} // namespace

#endif // OPENCV_REFRACT_CURVED_KERNELS_HPP
