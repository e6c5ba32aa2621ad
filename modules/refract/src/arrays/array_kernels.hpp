// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_ARRAY_KERNELS_HPP
#define OPENCV_REFRACT_ARRAY_KERNELS_HPP

/* No OpenCV in here, see dispatch/kernels.hpp. */

namespace cv { namespace refract {

//! Blocks of points, to and from what users gave.
struct ArrayKernels
{
    //! n interleaved points of 2 (z null) or 3 coordinates -> arrays; true if all are finite.
    bool (*load)(const void* points, bool isFloat, int n, double* x, double* y, double* z);
    void (*store)(void* points, bool isFloat, int n, const double* x, const double* y, const double* z);
    //! No point is extreme (moderate.hpp).
    bool (*areModerate)(int n, const double* x, const double* y, const double* z);
};

const ArrayKernels& arrayKernels();

}} // namespace

#endif // OPENCV_REFRACT_ARRAY_KERNELS_HPP
