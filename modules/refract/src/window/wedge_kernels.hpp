// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_WEDGE_KERNELS_HPP
#define OPENCV_REFRACT_WEDGE_KERNELS_HPP

#include "window/faces.hpp"
#include "window/layer_kernels.hpp"

namespace cv { namespace refract {

//! What Layers asks for, of blocks of points, where faces are not parallel.
struct WedgeKernels
{
    //! As LayerKernels' traceOut; the origin is tau n + offset (3 columns).
    bool (*traceOut)(const TiltedFaces& window, int n, const double* wx, const double* wy, const double* wz,
                     double* tau, const Columns& offset, double* dx, double* dy, double* dz);
    //! As LayerKernels' solveIn; the stack is the same window with parallel faces, from where the search begins.
    bool (*solveIn)(const Stack& stack, const TiltedFaces& window, int n, const double* x, const double* y, const double* z,
                    const double* w, double* dx, double* dy, double* dz);
    //! As LayerKernels' chainWindow, from the directions that solveIn gave; two or three rows.
    void (*chain)(const TiltedFaces& window, int rows, int n, const double* x, const double* y, const double* z,
                  const double* dx, const double* dy, const double* dz, const Columns& byDirection, const Columns& byPoint,
                  const Columns& byWindow);
};

const WedgeKernels& wedgeKernels();

}} // namespace

#endif // OPENCV_REFRACT_WEDGE_KERNELS_HPP
