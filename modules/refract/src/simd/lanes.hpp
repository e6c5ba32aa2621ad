// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LANES_HPP
#define OPENCV_REFRACT_LANES_HPP

#include <cmath>
#include <cstring>
#if defined(__SSE2__)
#include <immintrin.h>
#elif defined(__GNUC__) && defined(__aarch64__)
#include <arm_neon.h>
#endif

/* Lanes: one vector register full of doubles. Arithmetic and comparisons are the compiler's own vector types, as wide as
the instruction set that this file is compiled for; only what they lack (square roots, the test of all lanes) is named
here. Where neither the compiler nor the processor is one of these, a lane is a plain double.

Everything has internal linkage: the same names are compiled several times for different instruction sets. */

namespace {

#if defined(__GNUC__) && defined(__AVX512F__) && defined(__AVX512DQ__)
typedef double Lanes __attribute__((vector_size(64)));
inline Lanes sqrt(Lanes a) { return (Lanes)_mm512_maskz_sqrt_pd(255, (__m512d)a); }
#elif defined(__GNUC__) && defined(__AVX2__)
typedef double Lanes __attribute__((vector_size(32)));
inline Lanes sqrt(Lanes a) { return (Lanes)_mm256_sqrt_pd((__m256d)a); }
#elif defined(__GNUC__) && defined(__SSE2__)
typedef double Lanes __attribute__((vector_size(16)));
inline Lanes sqrt(Lanes a) { return (Lanes)_mm_sqrt_pd((__m128d)a); }
#elif defined(__GNUC__) && defined(__aarch64__)
typedef double Lanes __attribute__((vector_size(16)));
inline Lanes sqrt(Lanes a) { return (Lanes)vsqrtq_f64((float64x2_t)a); }
#else
#define REFRACT_LANE_IS_DOUBLE
typedef double Lanes;
using std::sqrt;
#endif

enum { LANES = sizeof(Lanes)/sizeof(double) };
typedef decltype(Lanes{} < Lanes{}) Mask;       //!< all bits of a lane, or none

#if defined(__GNUC__) && defined(__AVX512F__) && defined(__AVX512DQ__)
inline bool any(Mask m) { return _mm512_movepi64_mask((__m512i)m) != 0; }
#elif defined(__GNUC__) && defined(__AVX2__)
inline bool any(Mask m) { return _mm256_movemask_pd((__m256d)m) != 0; }
#elif defined(__GNUC__) && defined(__SSE2__)
inline bool any(Mask m) { return _mm_movemask_pd((__m128d)m) != 0; }
#elif defined(__GNUC__) && defined(__aarch64__)
inline bool any(Mask m) { return vmaxvq_u32((uint32x4_t)m) != 0; }
#else
inline bool any(Mask m) { return m; }
#endif

inline Lanes all(double v) { return Lanes{} + v; }
inline Mask none() { return all(0) != 0; }
inline Mask isNot(Mask m) { return m == none(); }
inline Lanes select(Mask m, Lanes a, Lanes b) { return m ? a : b; }

//! 1/sqrt(a) to about two units in the last place, for normal a > 0; NaN for 0 and infinity is possible.
#if defined(__GNUC__) && defined(__AVX512F__) && defined(__AVX512DQ__)
inline Lanes inverseSqrt(Lanes a)
{
    // 14 bits from the instruction, times the series of 1/sqrt(1 - e) up to e^3: a third of the time of root and quotient.
    const Lanes y = (Lanes)_mm512_maskz_rsqrt14_pd(255, (__m512d)a), e = 1 - a*y*y;
    return y + y*(e*(0.5 + e*(0.375 + e*0.3125)));
}
#else
inline Lanes inverseSqrt(Lanes a) { return 1/sqrt(a); }
#endif

//! 1/a to eight digits at least: enough for the step of an iteration.
#if defined(__GNUC__) && defined(__AVX512F__) && defined(__AVX512DQ__)
inline Lanes roughInverse(Lanes a)
{
    const Lanes y = (Lanes)_mm512_maskz_rcp14_pd(255, (__m512d)a);
    return y + y*(1 - a*y);
}
#else
inline Lanes roughInverse(Lanes a) { return 1/a; }
#endif

inline Lanes absolute(Lanes a) { return select(a < 0, -a, a); }
inline Lanes larger(Lanes a, Lanes b) { return select(a > b, a, b); }
inline Lanes square(Lanes a) { return a*a; }

#ifndef REFRACT_LANE_IS_DOUBLE
// The same of one number: a formula is written once, for one point and for many.
inline bool any(bool m) { return m; }
inline double select(bool m, double a, double b) { return m ? a : b; }
inline double inverseSqrt(double a) { return 1/std::sqrt(a); }
inline double roughInverse(double a) { return 1/a; }
inline double larger(double a, double b) { return a > b ? a : b; }
inline double square(double a) { return a*a; }
#endif

//! The last n < LANES points of an array, the very last repeated, so that every lane holds a point; and back.
#if defined(__GNUC__) && defined(__AVX512F__) && defined(__AVX512DQ__)
inline __mmask8 firstLanes(int n) { return (__mmask8)((1 << n) - 1); }
inline Lanes loadTail(const double* p, int n)
{
    return (Lanes)_mm512_mask_loadu_pd(_mm512_set1_pd(p[n - 1]), firstLanes(n), p);
}
inline void storeTail(Lanes a, double* p, int n) { _mm512_mask_storeu_pd(p, firstLanes(n), (__m512d)a); }
#elif defined(__GNUC__) && defined(__AVX2__)
inline __m256i firstLanes(int n) { return _mm256_cmpgt_epi64(_mm256_set1_epi64x(n), _mm256_setr_epi64x(0, 1, 2, 3)); }
inline Lanes loadTail(const double* p, int n)
{
    const __m256i lanes = firstLanes(n);
    return (Lanes)_mm256_blendv_pd(_mm256_set1_pd(p[n - 1]), _mm256_maskload_pd(p, lanes), (__m256d)lanes);
}
inline void storeTail(Lanes a, double* p, int n) { _mm256_maskstore_pd(p, firstLanes(n), (__m256d)a); }
#else   // one or two lanes: one point
inline Lanes loadTail(const double* p, int) { return all(*p); }
inline void storeTail(Lanes a, double* p, int) { std::memcpy(p, &a, sizeof *p); }
#endif

//! Where in an array a register's lanes are: all of them, or the last few points that there are.
struct Whole { int begin; };
struct Part { int begin, n; };

inline Lanes load(const double* p, Whole at)
{
    Lanes a;
    std::memcpy(&a, p + at.begin, sizeof a);
    return a;
}
inline Lanes load(const double* p, Part at)
{
    const int left = at.n - at.begin;
    return left >= LANES ? load(p, Whole{ at.begin }) : loadTail(p + at.begin, left);
}

inline void store(Lanes a, double* p, Whole at) { std::memcpy(p + at.begin, &a, sizeof a); }
inline void store(Lanes a, double* p, Part at)
{
    const int left = at.n - at.begin;
    if (left >= LANES)
        store(a, p, Whole{ at.begin });
    else
        storeTail(a, p + at.begin, left);
}

//! body(at) for every register of an array of n.
template<typename Body>
inline void eachRegister(int n, const Body& body)
{
    int i = 0;
    for (; i + LANES <= n; i += LANES)
        body(Whole{ i });
    if (i < n)
        body(Part{ i, n });
}

//! Numbers that all lanes share, in a copy that no store can change: they stay in registers.
template<int N>
struct Constants
{
    explicit Constants(const double* numbers) { std::memcpy(value, numbers, sizeof value); }
    double operator[](int i) const { return value[i]; }
    double value[N];
};

/* An iteration is a chain of operations that wait for each other. Kernels that iterate therefore take a group of registers
through each stage before the next: the chains of a group run side by side. */
enum { GROUP = 8 };

template<typename Search>
struct Group
{
    //! step(search, at) for every register.
    template<typename Step>
    void each(const Step& step)
    {
        for (int g = 0; g < size; g++)
            step(search[g], Part{ begin + g*LANES, n });
    }
    //! Whether test(search) holds for any lane.
    template<typename Test>
    bool some(const Test& test) const
    {
        Mask lanes = none();
        for (int g = 0; g < size; g++)
            lanes |= test(search[g]);
        return any(lanes);
    }
    Search search[GROUP];
    int begin, n, size;
};

//! body(group) for every group of an array of n.
template<typename Search, typename Body>
inline void eachGroup(int n, const Body& body)
{
    Group<Search> group;
    group.n = n;
    for (group.begin = 0; group.begin < n; group.begin += GROUP*LANES)
    {
        const int registers = (n - group.begin + LANES - 1)/LANES;
        group.size = registers < GROUP ? registers : GROUP;
        body(group);
    }
}

//! Which lanes of a block have no answer; they are stored as NaN.
class Answers
{
public:
    //! The value where good, NaN elsewhere.
    Lanes where(Mask good, Lanes value)
    {
        const Lanes answer = select(good, value, all(NAN));
        missing_ |= answer != answer;
        return answer;
    }
    void add(const Answers& others) { missing_ |= others.missing_; }
    bool complete() const { return !any(missing_); }
private:
    Mask missing_ = none();
};

} // namespace

#endif // OPENCV_REFRACT_LANES_HPP
