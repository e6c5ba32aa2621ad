// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LAYER_KERNELS_HPP
#define OPENCV_REFRACT_LAYER_KERNELS_HPP

#include "simd/columns.hpp"
#include "window/layout.hpp"

/* Parallel layers as the vector code sees them. No OpenCV in here, see dispatch/kernels.hpp. */

namespace cv { namespace refract {

//! Gap and layers of one index, and whether the scene is of this index too.
struct Medium
{
    double height;      //!< of gap and layers together, as `scale` has it
    bool isScene;       //!< the scene's medium: its height, which varies from point to point, comes on top
    double scale;       //!< the rarest index, for the rarest medium 1: its height is taken as it is
    double index2;      //!< index^2
    double slope;       //!< of tan(theta) by the tangent in the rarest medium at 0, over `scale`
    double limit;       //!< tan(theta) at grazing in the rarest medium, over `scale`
};

//! Parallel layers as the kernels see them.
struct Stack
{
    double normal[3];
    bool refracts;              //!< false: no window, nothing below counts
    double total;               //!< sum of the heights
    double inner, outer;        //!< index of the camera's and the scene's medium
    double rarest;              //!< the smallest index
    const Medium* media;        //!< the rarest first
    int count;
    const double *heights, *indices;    //!< the gap, then the layers, as given
    int layers;                 //!< how many heights
    WindowLayout at;            //!< columns of derivatives
};

//! What Layers asks for, of blocks of points.
struct LayerKernels
{
    bool (*traceOut)(const Stack& stack, int n, const double* wx, const double* wy, const double* wz,
                     double* tau, double* dx, double* dy, double* dz);
    bool (*solveIn)(const Stack& stack, int n, const double* x, const double* y, const double* z, const double* w,
                    double* dx, double* dy, double* dz, double* ratio);
    void (*chainWindow)(const Stack& stack, int rows, int n, const double* x, const double* y, const double* z,
                        const double* ratio, const Columns& byDirection, const Columns& byPoint, const Columns& byWindow);
};

const LayerKernels& layerKernels();

}} // namespace

#endif // OPENCV_REFRACT_LAYER_KERNELS_HPP
