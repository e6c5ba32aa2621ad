// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CURVED_SIMD_HPP
#define OPENCV_REFRACT_CURVED_SIMD_HPP

#include "window/curved_derivatives.simd.hpp"

/* Light through tubes and bent panes, in the window's frame: faces Q(X) = g.X + X.K X/2 = distance, K = curvature diag(1, 1, third),
whose gradient g + K X has the length 1 on them. From P along the optical vector p a face is at

    s = 2 (distance - Q(P))/(b + c),    b = (g + K P).p,    c = sqrt(b^2 + 2 (p.K p)(distance - Q(P))),

which is regular for K = 0, and c = m.p there. Then as through planes, with the normal m at that point: p' = p + gamma m,
gamma = sqrt(c^2 + n'^2 - n^2) - c. */

namespace cv { namespace refract { namespace {

/* The outgoing line goes through P - (s_0 + s_1 + ...) p, which is - sum over the faces of gamma m (s_0 + ... up to there): a sum of
what is small, as behind a wedge. A tube's m are across its axis, and so is this point. */
bool traceOutCurved(const CurvedFaces& given, int n, const double* wx, const double* wy, const double* wz,
                    double* tau, const Columns& offset, double* dx, double* dy, double* dz)
{
    const CurvedFaces window = given;
    const double inverseOuter = 1/window.outer, *normal = window.normal;
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes zero = all(0);
        const Vector w = intoFrame(window.axes, { load(wx, at), load(wy, at), load(wz, at) });
        Vector p = { window.inner*w.x, window.inner*w.y, window.inner*w.z }, P = { zero, zero, zero }, origin = P;
        Lanes sum = zero;
        Mask good = leavesCamera(window, p);
        for (int k = 0; k < window.count; k++)
        {
            const CurvedFace& face = window.faces[k];
            const Crossing hit = crossingOf(window.third, face, P, p);
            const Lanes after2 = hit.c2 + face.excess, gamma = after2*inverseSqrt(after2) - hit.c;
            good &= (hit.c2 > 0) & (hit.s >= window.least) & (after2 > 0);
            P = plus(P, hit.s, p);
            p = plus(p, gamma, hit.m);
            sum += hit.s;
            origin = plus(origin, -gamma*sum, hit.m);
        }
        const Lanes along = dot(normal, origin);
        store(answers.where(good, along), tau, at);
        const Vector o = outOfFrame(window.axes, plus(origin, -along, normal)), d = outOfFrame(window.axes, p);
        storeAt(o.x, offset, 0, 0, at);
        storeAt(o.y, offset, 0, 1, at);
        storeAt(o.z, offset, 0, 2, at);
        store(d.x*inverseOuter, dx, at);
        store(d.y*inverseOuter, dy, at);
        store(d.z*inverseOuter, dz, at);
    });
    return answers.complete();
}

/* A point's direction: Newton's method in two tangents at the camera, of a tube in the angle about its axis and in the tangent
along it, in which a path is nearly linear however long it is. The error is by how much the line outside misses the point. */
struct CurvedSearch
{
    Vector X;                   //!< the point, in the window's frame
    Lanes weight;               //!< its w
    Vector v;                   //!< the direction: of a tube with (x, y) of length 1, of a pane with z = 1
    Lanes step2, length2;       //!< square of the last step; of v
    Mask good;
};

inline Vector ofUnitSection(const Vector& v)
{
    const Lanes scale = inverseSqrt(v.x*v.x + v.y*v.y);
    return { scale*v.x, scale*v.y, v.z };
}

//! The ray of v behind the last face, with what is beside it by each tangent.
struct CurvedRay
{
    Vector P, p, dP[2], dp[2];
};

inline void beginAlong(const CurvedFaces& window, bool isTube, CurvedSearch& search, CurvedRay& ray)
{
    const Lanes zero = all(0), one = all(1);
    const Vector v = search.v, tangents[2] = { isTube ? Vector{ -v.y, v.x, zero } : Vector{ one, zero, zero },
                                               isTube ? Vector{ zero, zero, one } : Vector{ zero, one, zero } };
    search.length2 = dot(v, v);
    const Lanes inverse = inverseSqrt(search.length2), scale = window.inner*inverse, inverse2 = inverse*inverse;
    search.good = leavesCamera(window, v);
    ray.P = ray.dP[0] = ray.dP[1] = { zero, zero, zero };
    ray.p = { scale*v.x, scale*v.y, scale*v.z };
    for (int j = 0; j < 2; j++)
        ray.dp[j] = plus({ scale*tangents[j].x, scale*tangents[j].y, scale*tangents[j].z }, -dot(v, tangents[j])*inverse2, ray.p);
}

inline void passCurved(const CurvedFaces& window, const CurvedFace& face, CurvedSearch& search, CurvedRay& ray)
{
    const double third = window.third;
    const Crossing hit = crossingOf(third, face, ray.P, ray.p);
    const Lanes after2 = hit.c2 + face.excess, inverse = inverseSqrt(after2), gamma = after2*inverse - hit.c, inverseC = 1/hit.c;
    search.good &= (hit.c2 > 0) & (hit.s >= window.least) & (after2 > 0);
    ray.P = plus(ray.P, hit.s, ray.p);
    for (int j = 0; j < 2; j++)
    {
        const Vector moved = plus(ray.dP[j], hit.s, ray.dp[j]);
        ray.dP[j] = plus(moved, -dot(hit.m, moved)*inverseC, ray.p);
        const Vector dm = bentBy(face.curvature, third, ray.dP[j]);
        const Lanes dGamma = (dot(dm, ray.p) + dot(hit.m, ray.dp[j]))*(hit.c*inverse - 1);
        ray.dp[j] = plus(plus(ray.dp[j], dGamma, hit.m), gamma, dm);
    }
    ray.p = plus(ray.p, gamma, hit.m);
}

inline void stepCurved(const CurvedFaces& window, bool isTube, CurvedSearch& search)
{
    CurvedRay ray;
    beginAlong(window, isTube, search, ray);
    for (int k = 0; k < window.count; k++)
        passCurved(window, window.faces[k], search, ray);
    // What the line misses X by is to be the sum of the two motions of it, along p anything.
    const Lanes w = search.weight;
    const Vector way = plus(search.X, -w, ray.P);
    const Lanes s = dot(way, ray.p)*(1/(window.outer*window.outer));
    const Vector miss = plus(way, -s, ray.p), first = plus(ray.dp[0], w/s, ray.dP[0]), second = plus(ray.dp[1], w/s, ray.dP[1]);
    const Vector across = cross(second, ray.p);
    const Lanes area = dot(first, across), inverse = roughInverse(s*area);
    const Lanes a = dot(miss, across)*inverse, b = dot(miss, cross(ray.p, first))*inverse;
    search.good &= (s > 0) & (area > 0);
    search.step2 = a*a + b*b;
    const Vector v = search.v;
    if (isTube)
        search.v = ofUnitSection({ v.x - a*v.y, v.y + a*v.x, v.z + b });
    else
        search.v = { v.x + a, v.y + b, v.z };
}

bool solveInCurved(const CurvedFaces& given, int n, const double* px, const double* py, const double* pz, const double* pw,
                   double* dx, double* dy, double* dz)
{
    // What a step leaves is a few times its square, over the length of the direction.
    const double ENOUGH = 3e-9;
    const int STEPS = 10;
    const CurvedFaces window = given;
    const bool isTube = window.third == 0;
    const CurvedFace& last = window.faces[window.count - 1];
    Answers answers;
    const auto isLeft = [&](const CurvedSearch& search) { return search.step2 > ENOUGH*ENOUGH*search.length2; };
    eachGroup<CurvedSearch>(n, [&](Group<CurvedSearch>& group)
    {
        group.each([&](CurvedSearch& search, Part at)
        {
            search.weight = pw ? load(pw, at) : all(1);
            search.X = intoFrame(window.axes, { load(px, at), load(py, at), load(pz, at) });
            const Vector v = intoFrame(window.axes, { load(dx, at), load(dy, at), load(dz, at) });
            const Lanes scale = isTube ? inverseSqrt(v.x*v.x + v.y*v.y) : 1/v.z;
            search.v = { scale*v.x, scale*v.y, scale*v.z };
        });
        bool more = true;
        for (int k = 0; k < STEPS && more; k++)
        {
            group.each([&](CurvedSearch& search, Part) { stepCurved(window, isTube, search); });
            more = group.some(isLeft);
        }
        group.each([&](CurvedSearch& search, Part at)
        {
            const Vector v = outOfFrame(window.axes, search.v);
            const Mask good = search.good & isBeyond(window.third, last, search.X, search.weight)
                              & (search.step2 <= ENOUGH*ENOUGH*search.length2);
            store(answers.where(good, v.x), dx, at);
            store(v.y, dy, at);
            store(v.z, dz, at);
        });
    });
    return answers.complete();
}

constexpr CurvedKernels curvedTable = { traceOutCurved, solveInCurved, chainCurved };

}}} // namespace

#endif // OPENCV_REFRACT_CURVED_SIMD_HPP
