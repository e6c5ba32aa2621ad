// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LENS_KERNELS_HPP
#define OPENCV_REFRACT_LENS_KERNELS_HPP

#include "simd/columns.hpp"

/* A lens as the vector code sees it. No OpenCV in here, see dispatch/kernels.hpp. */

namespace cv { namespace refract {

//! Terms of the polynomial that guesses a lens's inverse radial function.
enum { TERMS = 7 };

//! What a lens asks for, of blocks of directions and pixels.
template<typename Model>
struct LensKernels
{
    bool (*project)(const Model& lens, int n, const double* x, const double* y, const double* z, double* u, double* v);
    bool (*unproject)(const Model& lens, int n, const double* u, const double* v, double* x, double* y, double* z);
    bool (*projectJacobian)(const Model& lens, int n, const double* x, const double* y, const double* z,
                            double* u, double* v, const Columns& byDirection, const Columns& byParameters);
};

}} // namespace

#endif // OPENCV_REFRACT_LENS_KERNELS_HPP
