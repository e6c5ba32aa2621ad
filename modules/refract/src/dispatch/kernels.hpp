// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNELS_HPP
#define OPENCV_REFRACT_KERNELS_HPP

#include "arrays/array_kernels.hpp"
#include "lens/fisheye_model.hpp"
#include "lens/opencv_model.hpp"
#include "lens/spline_model.hpp"
#include "points/point_kernels.hpp"
#include "window/curved_kernels.hpp"
#include "window/dome_kernels.hpp"
#include "window/layer_kernels.hpp"
#include "window/wedge_kernels.hpp"

/* The inner loops, over blocks of structure-of-arrays. They are written once (*.simd.hpp of each component), compiled for every
instruction set (kernels_baseline.cpp, kernels_avx2.cpp, kernels_avx512.cpp) and chosen at run time (kernels.cpp). Each component
declares its own (*_kernels.hpp), defines them, and asks only for them; here they come together.

A kernel computes the regular case. It returns true if all lanes have an answer. A lane that has none, or none yet, is NaN in the
kernel's first output: the caller's scalar path then computes the answer or the status. NaN lanes pass through.

No OpenCV in here: an inline function of another header, compiled for AVX-512 and kept by the linker, would run on
machines that do not have it. Its universal intrinsics, whose namespace is the level's, are the exception (lanes_universal.hpp). */

namespace cv { namespace refract {

/* What each component declares: the type of its kernels, and their name. The component asks for them by name-Kernels(); name-Table
is its constant in the component's *.simd.hpp. */
#define REFRACT_KERNELS(EACH) \
    EACH(ArrayKernels, array) \
    EACH(LayerKernels, layer) \
    EACH(WedgeKernels, wedge) \
    EACH(DomeKernels, dome) \
    EACH(CurvedKernels, curved) \
    EACH(LensKernels<OpenCVModel>, openCV) \
    EACH(LensKernels<FisheyeModel>, fisheye) \
    EACH(SplineKernels, spline) \
    EACH(PointKernels, point)

//! All of one level.
struct Kernels
{
    const char* instructions;
#define REFRACT_MEMBER(Type, name) Type name;
    REFRACT_KERNELS(REFRACT_MEMBER)
#undef REFRACT_MEMBER
};

//! The fastest that this machine runs (OPENCV_CPU_DISABLE=AVX512-SKX,AVX2 in the environment leaves levels out).
const Kernels& kernels();

// One for each level; null where the compiler was not told to compile for it.
const Kernels* kernelsBaseline();
const Kernels* kernelsAvx2();
const Kernels* kernelsAvx512();

}} // namespace

#endif // OPENCV_REFRACT_KERNELS_HPP
