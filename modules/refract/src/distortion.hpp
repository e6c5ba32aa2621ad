// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_DISTORTION_HPP
#define OPENCV_REFRACT_DISTORTION_HPP

#include "kernels.hpp"

/* The formula of OpenCV's lens model (lens_opencv.cpp states it), for one point (T = double) and for many (T = Lanes). */

namespace cv { namespace refract { namespace {

//! A distorted point before tilt, and its 2x2 Jacobian.
template<typename T>
struct Distorted
{
    T x, y, xx, xy, yx, yy;
    T determinant() const { return xx*yy - xy*yx; }
};

//! F = N/D of s = r^2, 1/D, and 2 dF/ds.
template<typename T>
inline void radialFactor(const OpenCVModel& m, T s, T& F, T& inverseD, T& F2)
{
    const double* k = m.k;
    const T N = 1 + s*(k[K1] + s*(k[K2] + s*k[K3])), dN = k[K1] + s*(2*k[K2] + s*(3*k[K3]));
    F = N;
    inverseD = 1 + 0*s;
    F2 = 2*dN;
    if (m.rational)
    {
        inverseD = 1/(1 + s*(k[K4] + s*(k[K5] + s*k[K6])));
        F = N*inverseD;
        F2 = 2*(dN - F*(k[K4] + s*(2*k[K5] + s*(3*k[K6]))))*inverseD;
    }
}

template<typename T>
inline Distorted<T> distort(const OpenCVModel& m, T x, T y)
{
    const double* k = m.k;
    const T s = x*x + y*y;
    T F, inverseD, F2;
    radialFactor(m, s, F, inverseD, F2);
    const T prismX = 2*(k[S1] + (2*k[S2])*s), prismY = 2*(k[S3] + (2*k[S4])*s);
    const T cross = F2*x*y + (2*k[P1])*x + (2*k[P2])*y;
    Distorted<T> d;
    d.x = x*F + (2*k[P1])*x*y + k[P2]*(s + 2*x*x) + s*(k[S1] + s*k[S2]);
    d.y = y*F + k[P1]*(s + 2*y*y) + (2*k[P2])*x*y + s*(k[S3] + s*k[S4]);
    d.xx = F + F2*x*x + (2*k[P1])*y + (6*k[P2])*x + x*prismX;
    d.xy = cross + y*prismX;
    d.yx = cross + x*prismY;
    d.yy = F + F2*y*y + (6*k[P1])*y + (2*k[P2])*x + y*prismY;
    return d;
}

//! (x, y, 1) through a homography: dehomogenised, and the denominator.
template<typename T>
inline T homography(const double* H, T& x, T& y)
{
    const T a = H[0]*x + H[1]*y + H[2], b = H[3]*x + H[4]*y + H[5], w = H[6]*x + H[7]*y + H[8], inverse = 1/w;
    x = a*inverse;
    y = b*inverse;
    return w;
}

}}} // namespace

#endif // OPENCV_REFRACT_DISTORTION_HPP
