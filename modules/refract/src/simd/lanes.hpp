// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LANES_HPP
#define OPENCV_REFRACT_LANES_HPP

#include <cmath>
#include <cstring>

/* Lanes: one vector register full of doubles, as wide as the instruction set that this file is compiled for. They are what the
compiler has, else what OpenCV has for it, else a plain double. Each of the three gives a Mask of lanes, the operators, and

    all none any isNot select sqrt      of lanes
    loadWhole storeWhole                a register
    loadTail storeTail                  the last n < LANES points of an array, the very last repeated, so that every lane holds
                                        a point; and back

and AVX-512 its inverses of 14 bits.

Everything has internal linkage: the same names are compiled several times for different instruction sets. */
#if defined(REFRACT_UNIVERSAL_INTRINSICS) || (defined(_MSC_VER) && !defined(__clang__) && (defined(_M_X64) || defined(_M_ARM64)))
#include "simd/lanes_universal.hpp"
#else
#include "simd/lanes_compiler.hpp"
#endif

namespace {

#ifndef REFRACT_HAS_LANES
typedef double Lanes;
typedef bool Mask;
inline double all(double v) { return v; }
inline bool none() { return false; }
inline bool isNot(bool m) { return !m; }
using std::sqrt;
inline double loadWhole(const double* p) { return *p; }
inline void storeWhole(double a, double* p) { *p = a; }
inline double loadTail(const double* p, int) { return *p; }
inline void storeTail(double a, double* p, int) { *p = a; }
#endif

enum { LANES = sizeof(Lanes)/sizeof(double) };

// Of one number as of many: a formula is written once, for one point and for many.
inline bool any(bool m) { return m; }
inline double select(bool m, double a, double b) { return m ? a : b; }
//! 1/sqrt(a) to about two units in the last place, for normal a > 0; NaN for 0 and infinity is possible.
inline double inverseSqrt(double a) { return 1/std::sqrt(a); }
//! 1/a to eight digits at least: enough for the step of an iteration.
inline double roughInverse(double a) { return 1/a; }
inline double absolute(double a) { return std::abs(a); }
inline double larger(double a, double b) { return a > b ? a : b; }
inline double square(double a) { return a*a; }

#ifdef REFRACT_HAS_LANES
#ifdef REFRACT_HAS_INVERSES_14      // 14 bits by an instruction
inline Lanes inverseSqrt(Lanes a)
{
    // Times the series of 1/sqrt(1 - e) up to e^3: a third of the time of root and quotient.
    const Lanes y = inverseSqrt14(a), e = 1 - a*y*y;
    return y + y*(e*(0.5 + e*(0.375 + e*0.3125)));
}
inline Lanes roughInverse(Lanes a)
{
    const Lanes y = inverse14(a);
    return y + y*(1 - a*y);
}
#else
inline Lanes inverseSqrt(Lanes a) { return 1/sqrt(a); }
inline Lanes roughInverse(Lanes a) { return 1/a; }
#endif
inline Lanes absolute(Lanes a) { return select(a < 0, -a, a); }
inline Lanes larger(Lanes a, Lanes b) { return select(a > b, a, b); }
inline Lanes square(Lanes a) { return a*a; }
#endif

//! Where in an array a register's lanes are: all of them, or the last few points that there are.
struct Whole { int begin; };
struct Part { int begin, n; };

inline Lanes load(const double* p, Whole at) { return loadWhole(p + at.begin); }
inline Lanes load(const double* p, Part at)
{
    const int left = at.n - at.begin;
    return left >= LANES ? load(p, Whole{ at.begin }) : loadTail(p + at.begin, left);
}

inline void store(Lanes a, double* p, Whole at) { storeWhole(a, p + at.begin); }
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
