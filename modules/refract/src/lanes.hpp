// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LANES_HPP
#define OPENCV_REFRACT_LANES_HPP

#include <cmath>
#include <cstring>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

/* Lanes: as many doubles as one register of the instruction set holds that this file is compiled for. Arithmetic and
comparisons are the compiler's own vector types; only what they lack (square root, tests of all lanes) is named here.
Everything has internal linkage: the same names are compiled several times for different instruction sets. */

namespace {

#if defined(__GNUC__) && defined(__AVX512F__) && defined(__AVX512DQ__)
enum { LANES = 8 };
#elif defined(__GNUC__) && defined(__AVX2__)
enum { LANES = 4 };
#elif defined(__GNUC__) && (defined(__SSE2__) || defined(__aarch64__))
enum { LANES = 2 };
#else
enum { LANES = 1 };
#endif

#if defined(__GNUC__)
typedef double Lanes __attribute__((vector_size(LANES*sizeof(double))));
typedef decltype(Lanes{} < Lanes{}) Mask;       //!< all bits of a lane, or none

inline Lanes all(double v) { return Lanes{} + v; }
inline Lanes select(Mask m, Lanes a, Lanes b) { return m ? a : b; }
#else
typedef double Lanes;
typedef bool Mask;

inline Lanes all(double v) { return v; }
inline Lanes select(Mask m, Lanes a, Lanes b) { return m ? a : b; }
#endif

#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__GNUC__)
inline Lanes sqrt(Lanes a) { return (Lanes)_mm512_maskz_sqrt_pd(255, (__m512d)a); }
inline bool any(Mask m) { return _mm512_movepi64_mask((__m512i)m) != 0; }
#elif defined(__AVX2__) && defined(__GNUC__)
inline Lanes sqrt(Lanes a) { return (Lanes)_mm256_sqrt_pd((__m256d)a); }
inline bool any(Mask m) { return _mm256_movemask_pd((__m256d)m) != 0; }
#elif defined(__SSE2__) && defined(__GNUC__)
inline Lanes sqrt(Lanes a) { return (Lanes)_mm_sqrt_pd((__m128d)a); }
inline bool any(Mask m) { return _mm_movemask_pd((__m128d)m) != 0; }
#elif defined(__GNUC__)
inline Lanes sqrt(Lanes a)
{
    for (int i = 0; i < LANES; ++i)
        a[i] = std::sqrt(a[i]);
    return a;
}
inline bool any(Mask m)
{
    long long bits = 0;
    for (int i = 0; i < LANES; ++i)
        bits |= m[i];
    return bits != 0;
}
#else
inline Lanes sqrt(Lanes a) { return std::sqrt(a); }
inline bool any(Mask m) { return m; }
#endif

inline Lanes noAnswer() { return all(NAN); }
inline Lanes absolute(Lanes a) { return select(a < 0, -a, a); }
inline Lanes larger(Lanes a, Lanes b) { return select(a > b, a, b); }
inline Lanes square(Lanes a) { return a*a; }

//! Lanes begin ... of an array of n; beyond its end the last element again, so that no lane holds what is not a number.
inline Lanes load(const double* p, int begin, int n)
{
    Lanes a;
    if (begin + LANES <= n)
        std::memcpy(&a, p + begin, sizeof a);
    else
    {
        double tail[LANES];
        for (int i = 0; i < LANES; ++i)
            tail[i] = p[begin + i < n ? begin + i : n - 1];
        std::memcpy(&a, tail, sizeof a);
    }
    return a;
}

inline void store(Lanes a, double* p, int begin, int n)
{
    if (begin + LANES <= n)
        std::memcpy(p + begin, &a, sizeof a);
    else
        std::memcpy(p + begin, &a, sizeof(double)*(n - begin));
}

} // namespace

#endif // OPENCV_REFRACT_LANES_HPP
