// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_TABLE_HPP
#define OPENCV_REFRACT_TABLE_HPP

#include "arrays/arrays.simd.hpp"
#include "dispatch/kernels.hpp"
#include "lens/fisheye.simd.hpp"
#include "lens/opencv.simd.hpp"
#include "lens/spline.simd.hpp"
#include "points/points.simd.hpp"
#include "window/curved.simd.hpp"
#include "window/dome.simd.hpp"
#include "window/layers.simd.hpp"
#include "window/wedge.simd.hpp"

namespace cv { namespace refract { namespace {

//! All kernels as compiled here. A constant: looking at it takes no instruction that a machine may not have.
constexpr Kernels table = {
#if defined(__AVX512DQ__)
    "AVX-512",
#elif defined(__AVX2__)
    "AVX2",
#else
    "baseline",
#endif
#define REFRACT_ENTRY(Type, name) name##Table,
    REFRACT_KERNELS(REFRACT_ENTRY)
#undef REFRACT_ENTRY
};

}}} // namespace

#endif // OPENCV_REFRACT_TABLE_HPP
