// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "precomp.hpp"
#include "dispatch/kernels.hpp"

namespace cv { namespace refract {

static const Kernels& choose()
{
    if (checkHardwareSupport(CV_CPU_AVX512_SKX) && kernelsAvx512())
        return *kernelsAvx512();
    if (checkHardwareSupport(CV_CPU_AVX2) && checkHardwareSupport(CV_CPU_FMA3) && kernelsAvx2())
        return *kernelsAvx2();
    return *kernelsBaseline();
}

const Kernels& kernels()
{
    static const Kernels& chosen = choose();
    return chosen;
}

#define REFRACT_ACCESSOR(Type, name) const Type& name##Kernels() { return kernels().name; }
REFRACT_KERNELS(REFRACT_ACCESSOR)
#undef REFRACT_ACCESSOR

}} // namespace
