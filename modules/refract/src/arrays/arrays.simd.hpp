// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_ARRAYS_SIMD_HPP
#define OPENCV_REFRACT_ARRAYS_SIMD_HPP

#include "arrays/array_kernels.hpp"
#include "arrays/moderate.hpp"
#include "simd/lanes.hpp"

/* Interleaved points of either depth <-> arrays of coordinates. */

namespace cv { namespace refract { namespace {

template<typename T>
inline void deinterleave(const T* p, int n, double* x, double* y, double* z)
{
    if (z)
        for (int i = 0; i < n; i++)
        {
            x[i] = p[3*i];
            y[i] = p[3*i + 1];
            z[i] = p[3*i + 2];
        }
    else
        for (int i = 0; i < n; i++)
        {
            x[i] = p[2*i];
            y[i] = p[2*i + 1];
        }
}

bool loadPoints(const void* points, bool isFloat, int n, double* x, double* y, double* z)
{
    if (isFloat)
        deinterleave((const float*)points, n, x, y, z);
    else
        deinterleave((const double*)points, n, x, y, z);
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        Lanes sum = load(x, at) + load(y, at);
        if (z)
            sum += load(z, at);
        answers.where(sum - sum == 0, sum);
    });
    return answers.complete();
}

template<typename T>
inline void interleave(T* p, int n, const double* x, const double* y, const double* z)
{
    if (z)
        for (int i = 0; i < n; i++)
        {
            p[3*i] = (T)x[i];
            p[3*i + 1] = (T)y[i];
            p[3*i + 2] = (T)z[i];
        }
    else
        for (int i = 0; i < n; i++)
        {
            p[2*i] = (T)x[i];
            p[2*i + 1] = (T)y[i];
        }
}

void storePoints(void* points, bool isFloat, int n, const double* x, const double* y, const double* z)
{
    if (isFloat)
        interleave((float*)points, n, x, y, z);
    else
        interleave((double*)points, n, x, y, z);
}

bool areModerate(int n, const double* x, const double* y, const double* z)
{
    Mask extreme = none();
    eachRegister(n, [&](auto at) { extreme |= isExtreme(load(x, at), load(y, at), load(z, at)); });
    return !any(extreme);
}

constexpr ArrayKernels arrayTable = { loadPoints, storePoints, areModerate };

}}} // namespace

#endif // OPENCV_REFRACT_ARRAYS_SIMD_HPP
