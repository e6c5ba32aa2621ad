// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifdef __AVX512DQ__
#include "dispatch/table.hpp"
#else
#include "dispatch/kernels.hpp"
#endif

namespace cv { namespace refract {

const Kernels* kernelsAvx512()
{
#ifdef __AVX512DQ__
    return &table;
#else
    return nullptr;     // see cmake/kernels.cmake
#endif
}

}} // namespace
