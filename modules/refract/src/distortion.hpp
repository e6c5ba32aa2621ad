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

//! What the radius alone determines: s = r^2, F = N/D, 1/D.
template<typename T>
struct Radial
{
    Radial(const OpenCVModel& m, T s_) : s(s_)
    {
        const double* k = m.k;
        F = 1 + s*(k[K1] + s*(k[K2] + s*k[K3]));
        inverseD = 1 + T();
        if (m.rational)
        {
            inverseD = 1/(1 + s*(k[K4] + s*(k[K5] + s*k[K6])));
            F *= inverseD;
        }
    }
    //! 2 dF/ds
    T slope(const OpenCVModel& m) const
    {
        const double* k = m.k;
        const T dN = 2*k[K1] + s*(4*k[K2] + s*(6*k[K3]));
        return m.rational ? (dN - F*(2*k[K4] + s*(4*k[K5] + s*(6*k[K6]))))*inverseD : dN;
    }
    T s, F, inverseD;
};

/** The distorted point. As x F + 2 p1 x y + p2 (s + 2 x^2) = x G + p2 s and the same for y, with
G = F + 2 p1 y + 2 p2 x, one factor serves both coordinates, and both diagonal elements of the Jacobian.
@return G */
template<typename T>
inline T displace(const OpenCVModel& m, const Radial<T>& radial, T x, T y, T& xd, T& yd)
{
    const double* k = m.k;
    const T s = radial.s, G = radial.F + (2*k[P1])*y + (2*k[P2])*x;
    xd = x*G + k[P2]*s;
    yd = y*G + k[P1]*s;
    if (m.prism)
    {
        xd += s*(k[S1] + s*k[S2]);
        yd += s*(k[S3] + s*k[S4]);
    }
    return G;
}

template<typename T>
inline Distorted<T> distort(const OpenCVModel& m, T x, T y)
{
    const double* k = m.k;
    const Radial<T> radial(m, x*x + y*y);
    const T F2 = radial.slope(m), ax = F2*x, ay = F2*y;
    Distorted<T> d;
    const T G = displace(m, radial, x, y, d.x, d.y);
    d.xx = G + x*(ax + 4*k[P2]);
    d.yy = G + y*(ay + 4*k[P1]);
    d.xy = d.yx = ax*y + (2*k[P1])*x + (2*k[P2])*y;
    if (m.prism)
    {
        const T prismX = 2*k[S1] + (4*k[S2])*radial.s, prismY = 2*k[S3] + (4*k[S4])*radial.s;
        d.xx += x*prismX;
        d.xy += y*prismX;
        d.yx += x*prismY;
        d.yy += y*prismY;
    }
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
