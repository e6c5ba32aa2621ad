// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LANES_COMPILER_HPP
#define OPENCV_REFRACT_LANES_COMPILER_HPP

#if (defined(__GNUC__) || defined(__clang__)) && \
    (defined(__SSE2__) || defined(__aarch64__) || defined(__VSX__) || defined(__riscv_vector) || defined(__wasm_simd128__) || \
     defined(__loongarch_sx))
#define REFRACT_HAS_LANES

#include <cmath>
#include <cstring>
#if defined(__SSE2__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

/* Lanes as the vector types of GNU's compilers and clang, on processors with registers of two doubles or more: arithmetic and
comparisons are the compiler's own, and only what they lack (square roots, the test of all lanes, masked memory) is named here. */

namespace {

#if defined(__AVX512F__) && defined(__AVX512DQ__)
typedef double Lanes __attribute__((vector_size(64)));
inline Lanes sqrt(Lanes a) { return (Lanes)_mm512_maskz_sqrt_pd(255, (__m512d)a); }
#elif defined(__AVX2__)
typedef double Lanes __attribute__((vector_size(32)));
inline Lanes sqrt(Lanes a) { return (Lanes)_mm256_sqrt_pd((__m256d)a); }
#else
typedef double Lanes __attribute__((vector_size(16)));
#if defined(__SSE2__)
inline Lanes sqrt(Lanes a) { return (Lanes)_mm_sqrt_pd((__m128d)a); }
#elif defined(__aarch64__)
inline Lanes sqrt(Lanes a) { return (Lanes)vsqrtq_f64((float64x2_t)a); }
#else   // without errno (cmake/kernels.cmake) compilers make one instruction of the two
inline Lanes sqrt(Lanes a) { return Lanes{ std::sqrt(a[0]), std::sqrt(a[1]) }; }
#endif
#endif

typedef decltype(Lanes{} < Lanes{}) Mask;       //!< all bits of a lane, or none

#if defined(__AVX512F__) && defined(__AVX512DQ__)
inline bool any(Mask m) { return _mm512_movepi64_mask((__m512i)m) != 0; }
#elif defined(__AVX2__)
inline bool any(Mask m) { return _mm256_movemask_pd((__m256d)m) != 0; }
#elif defined(__SSE2__)
inline bool any(Mask m) { return _mm_movemask_pd((__m128d)m) != 0; }
#elif defined(__aarch64__)
inline bool any(Mask m) { return vmaxvq_u32((uint32x4_t)m) != 0; }
#else
inline bool any(Mask m) { return (m[0] | m[1]) != 0; }
#endif

inline Lanes all(double v) { return Lanes{} + v; }
inline Mask none() { return all(0) != 0; }
inline Mask isNot(Mask m) { return m == none(); }
inline Lanes select(Mask m, Lanes a, Lanes b) { return m ? a : b; }

#if defined(__AVX512F__) && defined(__AVX512DQ__)
#define REFRACT_HAS_INVERSES_14
inline Lanes inverseSqrt14(Lanes a) { return (Lanes)_mm512_maskz_rsqrt14_pd(255, (__m512d)a); }
inline Lanes inverse14(Lanes a) { return (Lanes)_mm512_maskz_rcp14_pd(255, (__m512d)a); }
#endif

inline Lanes loadWhole(const double* p)
{
    Lanes a;
    std::memcpy(&a, p, sizeof a);
    return a;
}
inline void storeWhole(Lanes a, double* p) { std::memcpy(p, &a, sizeof a); }

#if defined(__AVX512F__) && defined(__AVX512DQ__)
inline __mmask8 firstLanes(int n) { return (__mmask8)((1 << n) - 1); }
inline Lanes loadTail(const double* p, int n)
{
    return (Lanes)_mm512_mask_loadu_pd(_mm512_set1_pd(p[n - 1]), firstLanes(n), p);
}
inline void storeTail(Lanes a, double* p, int n) { _mm512_mask_storeu_pd(p, firstLanes(n), (__m512d)a); }
#elif defined(__AVX2__)
inline __m256i firstLanes(int n) { return _mm256_cmpgt_epi64(_mm256_set1_epi64x(n), _mm256_setr_epi64x(0, 1, 2, 3)); }
inline Lanes loadTail(const double* p, int n)
{
    const __m256i lanes = firstLanes(n);
    return (Lanes)_mm256_blendv_pd(_mm256_set1_pd(p[n - 1]), _mm256_maskload_pd(p, lanes), (__m256d)lanes);
}
inline void storeTail(Lanes a, double* p, int n) { _mm256_maskstore_pd(p, firstLanes(n), (__m256d)a); }
#else   // of two lanes: one point
inline Lanes loadTail(const double* p, int) { return all(*p); }
inline void storeTail(Lanes a, double* p, int) { std::memcpy(p, &a, sizeof *p); }
#endif

} // namespace

#endif // vector registers

#endif // OPENCV_REFRACT_LANES_COMPILER_HPP
