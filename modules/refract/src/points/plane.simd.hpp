// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_PLANE_SIMD_HPP
#define OPENCV_REFRACT_PLANE_SIMD_HPP

#include "points/point_kernels.hpp"
#include "simd/vectors.hpp"

/* Rays, which may be beside the axis, and where they meet a plane. */

namespace cv { namespace refract { namespace {

//! Where rays are off the axis: by how much, and the last face, which leans.
struct OffAxis { Columns offset; Surface lastSurface; };
struct OnAxis {};

template<typename At>
inline Vector originOf(const OnAxis&, const double* axis, Lanes tau, At) { return { tau*axis[0], tau*axis[1], tau*axis[2] }; }
template<typename At>
inline Vector originOf(const OffAxis& off, const double* axis, Lanes tau, At at)
{
    const Vector offset = loadRow(off.offset, 0, at);
    return { tau*axis[0] + offset.x, tau*axis[1] + offset.y, tau*axis[2] + offset.z };
}

bool meetPlane(const Stack& stack, const Surface& lastSurface, const double* plane, const double* planeD, int n, const double* tau,
               const double* dx, const double* dy, const double* dz, double* x, double* y, double* z, double* mu)
{
    const Stack s = stack;
    const Surface last = lastSurface;
    const Constants<3> normal(s.normal), abc(plane);
    const double axis = abc[0]*normal[0] + abc[1]*normal[1] + abc[2]*normal[2];
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes a = load(dx, at), b = load(dy, at), c = load(dz, at), t = load(tau, at);
        const Lanes along = abc[0]*a + abc[1]*b + abc[2]*c, ahead = load(planeD, at) - t*axis, m = along/ahead;
        const Lanes shift = m*t, X = a + shift*normal[0], Y = b + shift*normal[1], Z = c + shift*normal[2];
        Mask good = (along*ahead > 0) & (m - m == 0);
        if (s.refracts)
            good &= isBeyondAlong(last, X, Y, Z, m, a, b, c);
        store(answers.where(good, X), x, at);
        store(Y, y, at);
        store(Z, z, at);
        if (mu)
            store(m, mu, at);
    });
    return answers.complete();
}

bool meetPlaneOffAxis(const Stack& stack, const Surface& lastSurface, const Columns& offset, const double* plane, const double* planeD,
                      int n, const double* tau, const double* dx, const double* dy, const double* dz, double* x, double* y, double* z,
                      double* mu)
{
    const OffAxis off = { offset, lastSurface };
    const Constants<3> normal(stack.normal), abc(plane);
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Vector o = originOf(off, normal.value, load(tau, at), at), d = { load(dx, at), load(dy, at), load(dz, at) };
        const Lanes along = dot(abc.value, d), ahead = load(planeD, at) - dot(abc.value, o), m = along/ahead;
        const Vector X = { d.x + m*o.x, d.y + m*o.y, d.z + m*o.z };
        const Mask good = (along*ahead > 0) & (m - m == 0) &
                          isBeyondAlong(off.lastSurface, X.x, X.y, X.z, m, d.x, d.y, d.z);
        store(answers.where(good, X.x), x, at);
        store(X.y, y, at);
        store(X.z, z, at);
        if (mu)
            store(m, mu, at);
    });
    return answers.complete();
}

}}} // namespace

#endif // OPENCV_REFRACT_PLANE_SIMD_HPP
