// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_OPENCV_MODEL_HPP
#define OPENCV_REFRACT_OPENCV_MODEL_HPP

#include "lens/lens_kernels.hpp"
#include "simd/polynomial.hpp"

/* The formula of OpenCV's lens model (lens_opencv.cpp states it), for one point (T = double) and for many (T = Lanes). */

namespace cv { namespace refract {

//! Positions in OpenCV's order of coefficients.
enum { K1, K2, P1, P2, K3, K4, K5, K6, S1, S2, S3, S4, TAUX, TAUY, DIST_COEFFS };

//! Terms of the rough guess of the inverse radial function.
enum { ROUGH_TERMS = 3 };

//! OpenCV's lens model as the kernels see it.
struct OpenCVModel
{
    double fx, fy, cx, cy;
    double k[DIST_COEFFS];
    double sMax;                //!< square of the radius where the radial part stops growing
    bool rational, prism, tilted;       //!< whether D, s1 ... s4, the tilt do anything
    double tilt[9];
    double untilt[9];                   //!< homography: pixels, from the principal point -> distorted points without tilt
    double dTilt[2][9];                 //!< derivatives of tilt by tau_x, tau_y
    int given;                          //!< how many coefficients are parameters
    double inverse[TERMS];      //!< r = rd (1 + rd^2 (inverse[0] + rd^2 (...))): where the search begins
    double rough[ROUGH_TERMS];  //!< the same, good to as much as is not radial
    int shifts;                 //!< how often that start is shifted for what is not radial
    double sNear, near2;        //!< where r^2 and the square of a Newton step are smaller, the step's error is nothing
};

const LensKernels<OpenCVModel>& openCVKernels();

namespace {

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

/** What of the distortion is not radial, s = x^2 + y^2, when G = 2 p1 y + 2 p2 x; with the radial factor added to G, all of it:
x F + 2 p1 x y + p2 (s + 2 x^2) = x G + p2 s, and the same for y. */
template<typename T>
inline void displace(const OpenCVModel& m, T s, T G, T x, T y, T& dx, T& dy)
{
    const double* k = m.k;
    dx = x*G + k[P2]*s;
    dy = y*G + k[P1]*s;
    if (m.prism)
    {
        dx += s*(k[S1] + s*k[S2]);
        dy += s*(k[S3] + s*k[S4]);
    }
}

template<typename T>
inline T tangential(const OpenCVModel& m, T x, T y) { return (2*m.k[P1])*y + (2*m.k[P2])*x; }

template<typename T>
inline Distorted<T> distort(const OpenCVModel& m, T x, T y)
{
    const double* k = m.k;
    const Radial<T> radial(m, x*x + y*y);
    const T F2 = radial.slope(m), ax = F2*x, ay = F2*y;
    Distorted<T> d;
    // G serves both coordinates, and both diagonal elements of the Jacobian.
    const T G = radial.F + tangential(m, x, y);
    displace(m, radial.s, G, x, y, d.x, d.y);
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

//! The undistorted point, were the distortion radial: by the polynomial of the inverse.
template<typename T>
inline void invertRadial(const OpenCVModel& m, T xr, T yr, T& x, T& y)
{
    const T scale = guessRatio(m.inverse, xr*xr + yr*yr);
    x = xr*scale;
    y = yr*scale;
}

//! The same by fewer terms, good enough to say what of the distortion is not radial.
template<typename T>
inline void invertRoughly(const OpenCVModel& m, T xr, T yr, T& x, T& y)
{
    const T s = xr*xr + yr*yr, scale = 1 + s*polynomial(m.rough, s);
    x = xr*scale;
    y = yr*scale;
}

//! Where the search for the undistorted point begins.
template<typename T>
inline void guess(const OpenCVModel& m, T xd, T yd, T& x, T& y)
{
    if (m.shifts == 0)
        invertRadial(m, xd, yd, x, y);
    else
        invertRoughly(m, xd, yd, x, y);
}

/** A better guess, the k-th of m.shifts: what is not radial is small and changes slowly, so it is taken off as it is at the
last guess. */
template<typename T>
inline void shift(const OpenCVModel& m, int k, T xd, T yd, T& x, T& y)
{
    T dx, dy;
    displace(m, x*x + y*y, tangential(m, x, y), x, y, dx, dy);
    if (k == m.shifts)
        invertRadial(m, xd - dx, yd - dy, x, y);
    else
        invertRoughly(m, xd - dx, yd - dy, x, y);
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

#endif // OPENCV_REFRACT_OPENCV_MODEL_HPP
