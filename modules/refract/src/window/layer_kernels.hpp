// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNELS_LAYERS_HPP
#define OPENCV_REFRACT_KERNELS_LAYERS_HPP

#include "dispatch/kernels.hpp"
#include "simd/lanes.hpp"

/* The physics of parallel layers, see layers.hpp. */

namespace cv { namespace refract { namespace {

bool traceOut(const Stack& stack, int n, const double* wx, const double* wy, const double* wz,
              double* tau, double* dx, double* dy, double* dz)
{
    const Stack s = stack;      // a copy that no store can change stays in registers
    const Constants<3> normal(s.normal);
    const double scale = s.inner/s.outer, inner2 = s.inner*s.inner, outer2 = s.outer*s.outer;
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes x = load(wx, at), y = load(wy, at), z = load(wz, at);
        const Lanes c = normal[0]*x + normal[1]*y + normal[2]*z, c2 = inner2*c*c;
        // q^2 = n^2 - p^2 by the cosine: no cancellation near grazing where the medium is the camera's
        const Lanes qOut2 = (outer2 - inner2) + c2, qOut = s.inner == s.outer ? s.inner*c : sqrt(qOut2);
        Mask good = (c > 0) & (qOut2 > 0);
        Lanes sum = all(0);
        for (int k = 0; k < s.count; ++k)
        {
            const Medium& medium = s.media[k];
            if (medium.isScene)
                continue;
            const Lanes q2 = (medium.index2 - inner2) + c2;
            good &= q2 > 0;
            sum += medium.height/medium.scale*(1 - qOut*inverseSqrt(q2));
        }
        const Lanes along = qOut*(1/s.outer) - scale*c;
        store(answers.where(good, sum), tau, at);
        store(scale*x + along*normal[0], dx, at);
        store(scale*y + along*normal[1], dy, at);
        store(scale*z + along*normal[2], dz, at);
    });
    return answers.complete();
}

bool meetPlane(const Stack& stack, const double* plane, const double* planeD, int n, const double* tau,
               const double* dx, const double* dy, const double* dz, double* x, double* y, double* z, double* mu)
{
    const Stack s = stack;
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
            good &= normal[0]*X + normal[1]*Y + normal[2]*Z > m*s.total;
        store(answers.where(good, X), x, at);
        store(Y, y, at);
        store(Z, z, at);
        if (mu)
            store(m, mu, at);
    });
    return answers.complete();
}

//! A search for the path from one point to the camera.
struct Path
{
    Lanes weight, scene;                //!< w of the point; height of the scene's medium
    Lanes radial[3], radius2;           //!< of the point about the window's axis
    Lanes ratio;                        //!< t / V, what is looked for
    Lanes step;                         //!< the last one, of ratio
};

inline Lanes heightOf(const Medium& medium, const Path& path)
{
    const Lanes height = path.weight*medium.height;
    return medium.isScene ? height + path.scene*medium.scale : height;
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
    Lanes ratio = roughInverse(slope);
    const Mask far = path.radius2*square(slope - rare) > square(limit*slope);
    if (any(far))
    {
        const Lanes radius = sqrt(path.radius2);
        ratio = select(far & (rare > 0), larger(ratio, (radius - limit)/(rare*radius)), ratio);
    }
    return ratio;
}

/** Halley's step towards F(ratio) = sum h_i tan(theta_i) / V - 1 = 0 (layers.cpp has the equation). */
inline Lanes pathStep(const Stack& s, const Path& path)
{
    const Lanes ratio = path.ratio, t2 = path.radius2*ratio*ratio;
    Lanes value = heightOf(s.media[0], path), slope = value, bend = all(0);
    for (int k = 1; k < s.count; ++k)
    {
        const Medium& medium = s.media[k];
        const double excess = medium.index2 - s.media[0].index2;
        const Lanes root2 = medium.index2 + excess*t2, inverse = inverseSqrt(root2), inverse2 = inverse*inverse;
        const Lanes term = heightOf(medium, path)*inverse, termSlope = term*medium.index2*inverse2;
        value += term;
        slope += termSlope;
        bend += termSlope*inverse2*excess;
    }
    const Lanes f = ratio*value - 1, half = 1.5*ratio*path.radius2*bend;    // half = -F''/2
    return -f*slope*roughInverse(slope*slope + f*half);
}

inline Path beginPath(const Stack& s, Lanes x, Lanes y, Lanes z, Lanes weight)
{
    const Lanes U = s.normal[0]*x + s.normal[1]*y + s.normal[2]*z;
    Path path;
    path.weight = weight;
    path.scene = U - weight*s.total;
    path.radial[0] = x - U*s.normal[0];
    path.radial[1] = y - U*s.normal[1];
    path.radial[2] = z - U*s.normal[2];
    path.radius2 = square(path.radial[0]) + square(path.radial[1]) + square(path.radial[2]);
    path.ratio = firstRatio(s, path);
    return path;
}

bool solveIn(const Stack& stack, int n, const double* px, const double* py, const double* pz, const double* pw,
             double* dx, double* dy, double* dz, double* ratio)
{
    // The relative error after a Halley step is a few times the cube of the relative step.
    const double ENOUGH = 1e-5;
    const int STEPS = 8;
    const Stack s = stack;
    const double inner2 = s.inner*s.inner, excess = inner2 - s.media[0].index2;
    Answers answers;
    eachGroup<Path>(n, [&](Group<Path>& group)
    {
        group.each([&](Path& path, Part at)
        {
            path = beginPath(s, load(px, at), load(py, at), load(pz, at), pw ? load(pw, at) : all(1));
        });
        bool more = true;
        for (int k = 0; k < STEPS && more; ++k)
        {
            group.each([&](Path& path, Part)
            {
                path.step = pathStep(s, path);
                path.ratio += path.step;
            });
            more = group.some([&](const Path& path) { return absolute(path.step) > ENOUGH*path.ratio; });
        }
        group.each([&](Path& path, Part at)
        {
            const Mask good = (path.scene > 0) & (absolute(path.step) <= ENOUGH*path.ratio);
            Lanes kappa = path.ratio;
            if (excess > 0)
                kappa *= s.rarest*inverseSqrt(inner2 + excess*path.radius2*path.ratio*path.ratio);
            store(answers.where(good, s.normal[0] + kappa*path.radial[0]), dx, at);
            store(s.normal[1] + kappa*path.radial[1], dy, at);
            store(s.normal[2] + kappa*path.radial[2], dz, at);
            if (ratio)
                store(path.ratio, ratio, at);
        });
    });
    return answers.complete();
}

}}} // namespace

#endif // OPENCV_REFRACT_KERNELS_LAYERS_HPP
