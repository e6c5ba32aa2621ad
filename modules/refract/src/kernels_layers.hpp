// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNELS_LAYERS_HPP
#define OPENCV_REFRACT_KERNELS_LAYERS_HPP

#include "kernels.hpp"
#include "lanes.hpp"

/* The physics of parallel layers, see layers.hpp. */

namespace cv { namespace refract { namespace {

bool traceOut(const Stack& s, int n, const double* wx, const double* wy, const double* wz,
              double* tau, double* dx, double* dy, double* dz)
{
    const double *normal = s.normal, scale = s.inner/s.outer, inner2 = s.inner*s.inner, outer2 = s.outer*s.outer;
    Mask bad = all(0) != 0;
    for (int i = 0; i < n; i += LANES)
    {
        const Lanes x = load(wx, i, n), y = load(wy, i, n), z = load(wz, i, n);
        const Lanes c = normal[0]*x + normal[1]*y + normal[2]*z, c2 = inner2*c*c;
        // q^2 = n^2 - p^2 by the cosine: no cancellation near grazing where the medium is the camera's
        const Lanes qOut2 = (outer2 - inner2) + c2, qOut = sqrt(qOut2);
        Mask good = (c > 0) & (qOut2 > 0);
        Lanes sum = all(0);
        for (int k = 0; k < s.count; ++k)
        {
            const Medium& medium = s.media[k];
            if (medium.scene == 1)
                continue;
            const Lanes q2 = (medium.index2 - inner2) + c2, q = sqrt(q2);
            good &= q2 > 0;
            sum += medium.height*(medium.index2 - outer2)/(q2 + q*qOut);
        }
        const Lanes along = qOut*(1/s.outer) - scale*c;
        bad |= ~good;
        store(select(good, sum, noAnswer()), tau, i, n);
        store(scale*x + along*normal[0], dx, i, n);
        store(scale*y + along*normal[1], dy, i, n);
        store(scale*z + along*normal[2], dz, i, n);
    }
    return !any(bad);
}

bool meetPlane(const Stack& s, const double* abc, const double* planeD, int n, const double* tau,
               const double* dx, const double* dy, const double* dz, double* x, double* y, double* z, double* mu)
{
    const double *normal = s.normal, axis = abc[0]*normal[0] + abc[1]*normal[1] + abc[2]*normal[2];
    Mask bad = all(0) != 0;
    for (int i = 0; i < n; i += LANES)
    {
        const Lanes a = load(dx, i, n), b = load(dy, i, n), c = load(dz, i, n), t = load(tau, i, n);
        const Lanes along = abc[0]*a + abc[1]*b + abc[2]*c, ahead = load(planeD, i, n) - t*axis, m = along/ahead;
        const Lanes shift = m*t, X = a + shift*normal[0], Y = b + shift*normal[1], Z = c + shift*normal[2];
        Mask good = (along*ahead > 0) & (m - m == 0);
        if (s.refracts)
            good &= normal[0]*X + normal[1]*Y + normal[2]*Z > m*s.total;
        bad |= ~good;
        store(select(good, X, noAnswer()), x, i, n);
        store(Y, y, i, n);
        store(Z, z, i, n);
        store(m, mu, i, n);
    }
    return !any(bad);
}

//! One point as the equation of its path sees it: height and radius^2 about the window's axis.
struct Path
{
    Lanes weight, scene, radius2;       //!< scene: height of the scene's medium
};

inline Lanes heightOf(const Medium& medium, const Path& path)
{
    return path.weight*medium.height + path.scene*medium.scene;
}

/* Where the search for t / V begins: left of the root, the larger of two bounds. f lies below its tangent at 0; and
every denser medium stays below its limit. The second wins far out only. */
inline Lanes firstRatio(const Stack& s, const Path& path)
{
    const Lanes rare = heightOf(s.media[0], path);
    Lanes slope = rare, limit = all(0);
    for (int k = 1; k < s.count; ++k)
    {
        const Lanes h = heightOf(s.media[k], path);
        slope += h*s.media[k].slope;
        limit += h*s.media[k].limit;
    }
    Lanes ratio = 1/slope;
    const Mask far = path.radius2*square(slope - rare) > square(limit*slope);
    if (any(far))
    {
        const Lanes radius = sqrt(path.radius2);
        ratio = select(far & (rare > 0), larger(ratio, (radius - limit)/(rare*radius)), ratio);
    }
    return ratio;
}

/** Halley's step towards F(ratio) = sum h_i tan(theta_i) / V - 1 = 0 (layers.cpp has the equation). */
inline Lanes pathStep(const Stack& s, const Path& path, Lanes ratio)
{
    const Lanes t2 = path.radius2*ratio*ratio;
    Lanes value = heightOf(s.media[0], path), slope = value, bend = all(0);
    for (int k = 1; k < s.count; ++k)
    {
        const Medium& medium = s.media[k];
        const double excess = medium.index2 - s.media[0].index2;
        const Lanes root2 = medium.index2 + excess*t2, inverse = 1/sqrt(root2), inverse2 = inverse*inverse;
        const Lanes term = heightOf(medium, path)*s.rarest*inverse, termSlope = term*medium.index2*inverse2;
        value += term;
        slope += termSlope;
        bend += termSlope*inverse2*excess;
    }
    const Lanes f = ratio*value - 1, half = 1.5*ratio*path.radius2*bend;    // half = -F''/2
    return -f*slope/(slope*slope + f*half);
}

bool solveIn(const Stack& s, int n, const double* px, const double* py, const double* pz, const double* pw,
             double* dx, double* dy, double* dz)
{
    // The error after a Halley step is a few times the cube of the relative step: below the rounding from here on.
    const double ENOUGH = 1e-6;
    const int STEPS = 8;
    const double *normal = s.normal, inner2 = s.inner*s.inner, excess = inner2 - s.media[0].index2;
    Mask bad = all(0) != 0;
    for (int i = 0; i < n; i += LANES)
    {
        const Lanes x = load(px, i, n), y = load(py, i, n), z = load(pz, i, n);
        const Lanes U = normal[0]*x + normal[1]*y + normal[2]*z;
        const Lanes rx = x - U*normal[0], ry = y - U*normal[1], rz = z - U*normal[2];
        Path path;
        path.weight = pw ? load(pw, i, n) : all(1);
        path.scene = U - path.weight*s.total;
        path.radius2 = rx*rx + ry*ry + rz*rz;
        Lanes ratio = firstRatio(s, path), step = ratio;
        for (int k = 0; k < STEPS && any(absolute(step) > ENOUGH*ratio); ++k)
        {
            step = pathStep(s, path, ratio);
            ratio += step;
        }
        const Mask good = (path.scene > 0) & (absolute(step) <= ENOUGH*ratio);
        bad |= ~good;
        Lanes kappa = ratio;
        if (excess > 0)
            kappa *= s.rarest/sqrt(inner2 + excess*path.radius2*ratio*ratio);
        store(select(good, normal[0] + kappa*rx, noAnswer()), dx, i, n);
        store(normal[1] + kappa*ry, dy, i, n);
        store(normal[2] + kappa*rz, dz, i, n);
    }
    return !any(bad);
}

}}} // namespace

#endif // OPENCV_REFRACT_KERNELS_LAYERS_HPP
