// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_DOME_KERNELS_HPP
#define OPENCV_REFRACT_DOME_KERNELS_HPP

#include "simd/columns.hpp"
#include "window/layout.hpp"

/* A dome as the kernels see it. No OpenCV in here, see dispatch/kernels.hpp. */

namespace cv { namespace refract {

//! One face of a dome.
struct Sphere
{
    double radius, inverse;         //!< 1/radius
    double before2, after2;         //!< squares of the indices on both sides
    double after;
    double inverseBoth;             //!< 1/(before after)
};

//! All faces of a dome, the camera's first.
struct Dome
{
    double center[3];
    double along;                   //!< the axis that all rays meet, on which tau is: along axis = center
    const Sphere* faces;
    int count;
    double inner, outer;            //!< index of the camera's and the scene's medium
    WindowLayout at;                //!< columns of derivatives
};

//! What Layers asks for, of blocks of points, where faces are spheres.
struct DomeKernels
{
    //! As LayerKernels' traceOut.
    bool (*traceOut)(const Dome& dome, int n, const double* wx, const double* wy, const double* wz,
                     double* tau, double* dx, double* dy, double* dz);
    //! As LayerKernels' solveIn.
    bool (*solveIn)(const Dome& dome, int n, const double* x, const double* y, const double* z, const double* w,
                    double* dx, double* dy, double* dz);
    //! As LayerKernels' chainWindow, from the directions that solveIn gave; two or three rows.
    void (*chain)(const Dome& dome, int rows, int n, const double* x, const double* y, const double* z,
                  const double* dx, const double* dy, const double* dz, const Columns& byDirection, const Columns& byPoint,
                  const Columns& byWindow);
};

const DomeKernels& domeKernels();

}} // namespace

#endif // OPENCV_REFRACT_DOME_KERNELS_HPP
