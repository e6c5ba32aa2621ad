// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LANES_UNIVERSAL_HPP
#define OPENCV_REFRACT_LANES_UNIVERSAL_HPP

/* Lanes over OpenCV's universal intrinsics, the widest registers of fixed size that there are: where the compiler has no vector
types, or with REFRACT_UNIVERSAL_INTRINSICS.

OpenCV takes a file's instruction set from the definitions of its build, and outside that build no more than SSE2 or NEON. A file
of kernels is compiled for a level of its own: what the compiler says of it is said to OpenCV as OpenCV's build would, with a
namespace of that level, so that no inline function of another level is linked in its place. */
#if defined(__AVX2__) && !defined(OPENCV_CORE_CVDEF_H)
#include <immintrin.h>
#define CV_SSE3 1
#define CV_SSSE3 1
#define CV_SSE4_1 1
#define CV_SSE4_2 1
#define CV_AVX 1
#define CV_AVX2 1
#define CV_FMA3 1
#ifdef __AVX512DQ__
#define CV_AVX_512F 1
#define CV_AVX_512CD 1
#define CV_AVX_512VL 1
#define CV_AVX_512BW 1
#define CV_AVX_512DQ 1
#define CV_AVX512_COMMON 1
#define CV_AVX512_SKX 1
#define CV_CPU_DISPATCH_MODE AVX512_SKX
#else
#define CV_CPU_DISPATCH_MODE AVX2
#endif
#endif
#include "opencv2/core/utility.hpp"     // intrin.hpp by itself takes it for granted where there are no registers
#include "opencv2/core/hal/intrin.hpp"

#if CV_SIMD_64F && !CV_SIMD128_CPP
#define REFRACT_HAS_LANES

#include <cstring>

namespace {

//! All bits of a lane, or none.
struct Mask
{
    cv::v_float64 v;
};

struct Lanes
{
    Lanes() : v(cv::vx_setzero_f64()) {}
    Lanes(double a) : v(cv::vx_setall_f64(a)) {}
    Lanes(const cv::v_float64& a) : v(a) {}
    cv::v_float64 v;
};

#if CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR < 11      // where operators became functions
#define REFRACT_OPERATOR(Type, Argument, op, function) \
    inline Type operator op(const Argument& a, const Argument& b) { return { a.v op b.v }; }
inline Mask isNot(const Mask& m) { return { ~m.v }; }
#else
#define REFRACT_OPERATOR(Type, Argument, op, function) \
    inline Type operator op(const Argument& a, const Argument& b) { return { cv::function(a.v, b.v) }; }
inline Mask isNot(const Mask& m) { return { cv::v_not(m.v) }; }
#endif
REFRACT_OPERATOR(Lanes, Lanes, +, v_add)
REFRACT_OPERATOR(Lanes, Lanes, -, v_sub)
REFRACT_OPERATOR(Lanes, Lanes, *, v_mul)
REFRACT_OPERATOR(Lanes, Lanes, /, v_div)
REFRACT_OPERATOR(Lanes, Lanes, ^, v_xor)
REFRACT_OPERATOR(Mask, Lanes, <, v_lt)
REFRACT_OPERATOR(Mask, Lanes, >, v_gt)
REFRACT_OPERATOR(Mask, Lanes, <=, v_le)
REFRACT_OPERATOR(Mask, Lanes, >=, v_ge)
REFRACT_OPERATOR(Mask, Lanes, ==, v_eq)
REFRACT_OPERATOR(Mask, Mask, &, v_and)
REFRACT_OPERATOR(Mask, Mask, |, v_or)
#undef REFRACT_OPERATOR

// Not v_ne, for which NaN differs from NaN with SSE2 and NEON, but not with AVX.
inline Mask operator!=(const Lanes& a, const Lanes& b) { return isNot(a == b); }
inline Lanes operator-(const Lanes& a) { return a ^ -0.; }
inline Lanes& operator+=(Lanes& a, const Lanes& b) { return a = a + b; }
inline Lanes& operator-=(Lanes& a, const Lanes& b) { return a = a - b; }
inline Lanes& operator*=(Lanes& a, const Lanes& b) { return a = a*b; }
inline Mask& operator&=(Mask& a, const Mask& b) { return a = a & b; }
inline Mask& operator|=(Mask& a, const Mask& b) { return a = a | b; }

inline Lanes all(double v) { return v; }
inline Mask none() { return { cv::vx_setzero_f64() }; }
inline bool any(const Mask& m) { return cv::v_check_any(m.v); }
inline Lanes select(const Mask& m, const Lanes& a, const Lanes& b) { return cv::v_select(m.v, a.v, b.v); }
inline Lanes sqrt(const Lanes& a) { return cv::v_sqrt(a.v); }

#if CV_SIMD512      // there is no v_ function for these, without which all that iterates takes half as long again
#define REFRACT_HAS_INVERSES_14
inline Lanes inverseSqrt14(const Lanes& a) { return cv::v_float64(_mm512_maskz_rsqrt14_pd(255, a.v.val)); }
inline Lanes inverse14(const Lanes& a) { return cv::v_float64(_mm512_maskz_rcp14_pd(255, a.v.val)); }
#endif

inline Lanes loadWhole(const double* p) { return cv::vx_load(p); }
inline void storeWhole(const Lanes& a, double* p) { cv::v_store(p, a.v); }

// There are no masked loads and stores.
inline Lanes loadTail(const double* p, int n)
{
    if (n == 1)
        return *p;
    double lanes[sizeof(Lanes)/sizeof(double)];
    for (int i = 0; i < (int)(sizeof(Lanes)/sizeof(double)); i++)
        lanes[i] = p[i < n ? i : n - 1];
    return loadWhole(lanes);
}
inline void storeTail(const Lanes& a, double* p, int n)
{
    double lanes[sizeof(Lanes)/sizeof(double)];
    storeWhole(a, lanes);
    for (int i = 0; i < n; i++)
        p[i] = lanes[i];
}

} // namespace

#endif // registers of doubles

#endif // OPENCV_REFRACT_LANES_UNIVERSAL_HPP
