// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_EPIPOLAR_CURVE_SIMD_HPP
#define OPENCV_REFRACT_EPIPOLAR_CURVE_SIMD_HPP

#include "points/plane.simd.hpp"

/* Epipolar curves, and distances of pixels from them: see epipolar_curve.hpp for t and unit. */

namespace cv { namespace refract { namespace {

const double CURVE_END = 1e-10;     // of t, from infinity and from the ray's origin

//! How far along its ray the last surface is.
inline Lanes lengthToSurface(const OnAxis&, const CurveFrame& frame, Lanes tau, const Vector& origin, const Vector& d)
{
    return frame.lastSurface.curvature > 0 ? lengthTo(frame.lastSurface, origin.x, origin.y, origin.z, d.x, d.y, d.z)
                                           : (frame.lastSurface.distance - tau)/dot(frame.normal, d);
}
inline Lanes lengthToSurface(const OffAxis&, const CurveFrame& frame, Lanes, const Vector& origin, const Vector& d)
{ return lengthTo(frame.lastSurface, origin.x, origin.y, origin.z, d.x, d.y, d.z); }

template<typename Off>
inline bool curvesOfRays(const CurveFrame& given, const Off& off, int n, const double* pTau, const double* pdx, const double* pdy,
                         const double* pdz, const Columns& curves)
{
    const CurveFrame frame = given;
    const Constants<9> R(frame.R);
    const Constants<3> T(frame.T);
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes tau = load(pTau, at);
        const Vector d = { load(pdx, at), load(pdy, at), load(pdz, at) };
        const Vector c = originOf(off, frame.normal, tau, at);
        const Vector o = { dot(R.value, c) + T[0], dot(R.value + 3, c) + T[1], dot(R.value + 6, c) + T[2] };
        const Lanes length2 = dot(o, o), unit = select(length2 > 0, 1/sqrt(length2), all(1));
        Lanes sNear = larger(lengthToSurface(off, frame, tau, c, d), all(0)), tFar = all(CURVE_END);
        Mask good = d.x == d.x;
        if (frame.isLimited)
        {
            const Lanes sFar = (frame.far - c.z)/d.z;
            sNear = larger(sNear, (frame.near - c.z)/d.z);
            good &= (d.z > 0) & (sFar > sNear);
            tFar = larger(1/(1 + sFar*unit), tFar);
        }
        const Lanes tNear = 1/(1 + sNear*unit);
        storeAt(dot(R.value, d), curves, 0, CURVE_DIRECTION, at);
        storeAt(dot(R.value + 3, d), curves, 0, CURVE_DIRECTION + 1, at);
        storeAt(dot(R.value + 6, d), curves, 0, CURVE_DIRECTION + 2, at);
        storeAt(o.x, curves, 0, CURVE_ORIGIN, at);
        storeAt(o.y, curves, 0, CURVE_ORIGIN + 1, at);
        storeAt(o.z, curves, 0, CURVE_ORIGIN + 2, at);
        storeAt(unit, curves, 0, CURVE_UNIT, at);
        storeAt(answers.where(good, tFar), curves, 0, CURVE_FAR, at);
        storeAt(tNear*(1 - CURVE_END), curves, 0, CURVE_NEAR, at);      // not on the surface itself
    });
    return answers.complete();
}

bool curvesOf(const CurveFrame& frame, int n, const double* tau, const Columns& offset, const double* dx, const double* dy,
              const double* dz, const Columns& curves)
{
    return offset.data ? curvesOfRays(frame, OffAxis{ offset, frame.lastSurface }, n, tau, dx, dy, dz, curves)
                       : curvesOfRays(frame, OnAxis(), n, tau, dx, dy, dz, curves);
}

template<typename At>
inline Vector loadVector(const Columns& columns, int first, At at)
{
    return { load(columns.at(0, first), at), load(columns.at(0, first + 1), at), load(columns.at(0, first + 2), at) };
}

inline Lanes within(Lanes a, Lanes low, Lanes high) { return select(a < low, low, select(a > high, high, a)); }

/* The directions in which the other camera sees the curve lie in a plane across N = o x D, with o seen from the origin of the
pixel's own ray e: o + s D is parallel to the part of e in the plane where (o x e).N + s (D x e).N = 0. */
template<typename Off>
inline void nearestTo(const Columns& curves, const double* pAxis, const Off& off, int n, const double* pTau, const double* pdx,
                      const double* pdy, const double* pdz, double* pT)
{
    const Constants<3> axis(pAxis);
    eachRegister(n, [&](auto at)
    {
        const Lanes tau = load(pTau, at), unit = load(curves.at(0, CURVE_UNIT), at);
        const Lanes tFar = load(curves.at(0, CURVE_FAR), at), tNear = load(curves.at(0, CURVE_NEAR), at);
        const Vector e = { load(pdx, at), load(pdy, at), load(pdz, at) };
        const Vector D = loadVector(curves, CURVE_DIRECTION, at), o = loadVector(curves, CURVE_ORIGIN, at);
        const Vector own = originOf(off, axis.value, tau, at), from = { o.x - own.x, o.y - own.y, o.z - own.z };
        const Vector N = cross(from, D);
        const Lanes s = dot(cross(from, e), N)/dot(cross(e, D), N);
        const Lanes end = select(dot(e, D) > unit*dot(e, from), tFar, tNear);
        const Lanes t = within(select(s > 0, 1/(1 + s*unit), end), tFar, tNear);
        store(select(t == t, t, 0.5*(tFar + tNear)), pT, at);
    });
}

void nearestToRay(const Columns& curves, const double* axis, int n, const double* tau, const Columns& offset, const double* dx,
                  const double* dy, const double* dz, double* t)
{
    if (offset.data)
        nearestTo(curves, axis, OffAxis{ offset, Surface() }, n, tau, dx, dy, dz, t);
    else
        nearestTo(curves, axis, OnAxis(), n, tau, dx, dy, dz, t);
}

void curvePoints(const Columns& curves, int n, const double* pT, double* x, double* y, double* z)
{
    eachRegister(n, [&](auto at)
    {
        const Lanes t = load(pT, at), s = (1 - t)/(t*load(curves.at(0, CURVE_UNIT), at));
        const Vector D = loadVector(curves, CURVE_DIRECTION, at), o = loadVector(curves, CURVE_ORIGIN, at);
        store(o.x + s*D.x, x, at);
        store(o.y + s*D.y, y, at);
        store(o.z + s*D.z, z, at);
    });
}

void approachPixel(const Columns& curves, double enough, int n, const double* pixelU, const double* pixelV, const double* pu,
                   const double* pv, const Columns& byPoint, double* pT, const Columns& nearest)
{
    const double POINT = 1e-9;      // pixels: so short a curve has no direction
    eachRegister(n, [&](auto at)
    {
        const Lanes t = load(pT, at), tFar = load(curves.at(0, CURVE_FAR), at), tNear = load(curves.at(0, CURVE_NEAR), at);
        const Lanes speed = 1/(t*t*load(curves.at(0, CURVE_UNIT), at));     // of s by -t
        const Vector D = loadVector(curves, CURVE_DIRECTION, at);
        const Lanes cu = dot(loadRow(byPoint, 0, at), D)*speed, cv = dot(loadRow(byPoint, 1, at), D)*speed;
        const Lanes eu = load(pixelU, at) - load(pu, at), ev = load(pixelV, at) - load(pv, at);
        const Lanes c2 = cu*cu + cv*cv, inverse = 1/sqrt(c2), along = (eu*cu + ev*cv)*inverse, across = (cu*ev - cv*eu)*inverse;
        const Mask hasDirection = c2 > POINT*POINT;
        const Lanes next = within(t - along*inverse, tFar, tNear), step = absolute(next - t)*sqrt(c2);
        const Lanes moved = select(hasDirection, step, 0*(c2 + eu + ev));
        const Mask arrived = moved <= enough, atEnd = isNot(hasDirection) | (arrived & (absolute(along) > enough));
        const Lanes length = sqrt(larger(eu*eu + ev*ev, all(1e-300)));
        const Lanes distance = select(atEnd, select(across < 0, -length, length), across) + 0*moved;   // NaN where moved is
        store(select(arrived, t, next), pT, at);
        storeAt(distance, nearest, 0, NEAREST_DISTANCE, at);
        storeAt(select(atEnd, eu/distance, -cv*inverse), nearest, 0, NEAREST_NORMAL, at);
        storeAt(select(atEnd, ev/distance, cu*inverse), nearest, 0, NEAREST_NORMAL + 1, at);
        storeAt(moved, nearest, 0, NEAREST_MOVED, at);
        storeAt(select(atEnd, all(1), all(0)), nearest, 0, NEAREST_AT_END, at);
    });
}

/* The nearest point's own motion along the curve changes nothing. So the distance changes with the other's pixel by the normal n,
and with all else by -n dC, the image of a motion of X along any way that keeps it on the moving ray: for the first camera's
pixel the least one with the right image. Where an end stops X, it stays in the end's plane. */
void distanceDerivatives(const CurveMotion& given, int n, const double* px, const double* py, const double* pz,
                         const double* pdx, const double* pdy, const double* pdz, const double* pmx, const double* pmy,
                         const double* pmz, const Columns& byPoint1, const Columns& byPoint2, const Columns& nearest,
                         const Columns& out)
{
    const CurveMotion motion = given;
    const double *R = motion.R, *B = motion.dTranslation, *shift = motion.shift;
    eachRegister(n, [&](auto at)
    {
        const Lanes nu = load(nearest.at(0, NEAREST_NORMAL), at), nv = load(nearest.at(0, NEAREST_NORMAL + 1), at);
        const Vector a = loadRow(byPoint2, 0, at), b = loadRow(byPoint2, 1, at);
        const Vector g = { nu*a.x + nv*b.x, nu*a.y + nv*b.y, nu*a.z + nv*b.z };
        const Vector Y = { load(px, at) - shift[0], load(py, at) - shift[1], load(pz, at) - shift[2] };
        for (int k = 0; k < 3; k++)
        {
            const double* A = motion.dRotation[k];
            const Vector moved = { dot(A, Y), dot(A + 3, Y), dot(A + 6, Y) };
            storeAt(-dot(g, moved), out, 0, 4 + k, at);
            storeAt(-(g.x*B[k] + g.y*B[3 + k] + g.z*B[6 + k]), out, 0, 7 + k, at);
        }
        const Vector d = { load(pdx, at), load(pdy, at), load(pdz, at) }, m = { load(pmx, at), load(pmy, at), load(pmz, at) };
        const Vector h = { g.x*R[0] + g.y*R[3] + g.z*R[6], g.x*R[1] + g.y*R[4] + g.z*R[7], g.x*R[2] + g.y*R[5] + g.z*R[8] };
        const Lanes f = dot(h, d)/dot(m, d);
        const Vector k = { h.x - f*m.x, h.y - f*m.y, h.z - f*m.z };
        const Vector U = loadRow(byPoint1, 0, at), V = loadRow(byPoint1, 1, at);
        const Lanes UU = dot(U, U), UV = dot(U, V), VV = dot(V, V), kU = dot(k, U), kV = dot(k, V), inverse = 1/(UU*VV - UV*UV);
        storeAt((UV*kV - VV*kU)*inverse, out, 0, 0, at);
        storeAt((UV*kU - UU*kV)*inverse, out, 0, 1, at);
        storeAt(nu, out, 0, 2, at);
        storeAt(nv, out, 0, 3, at);
    });
}

}}} // namespace

#endif // OPENCV_REFRACT_EPIPOLAR_CURVE_SIMD_HPP
