// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_DOME_SIMD_HPP
#define OPENCV_REFRACT_DOME_SIMD_HPP

#include "window/dome_kernels.hpp"
#include "window/rays_beside.simd.hpp"

/* Light through spheres about one point S. The moment L = r x p about S, with the optical vector p = index * direction, is the same
in all media, l = |L|. At a face of radius R between the indices n and n' the direction turns about L by
asin(l/(n' R)) - asin(l/(n R)): with u = l/R, q^2 = n^2 - u^2 and q'^2 = n'^2 - u^2,

    cos = (q q' + u^2)/(n n'),    sin = u (q - q')/(n n')

and the turns of all faces add up as products of complex numbers: no angle, and regular where l = 0. No light gets through where
u > n'. */

namespace cv { namespace refract { namespace {

//! The turn of all faces: its cosine, and its sine over l.
struct Turning
{
    Lanes cosine, sine;
    Mask good;
};

inline Turning turnBy(const Dome& dome, Lanes l2)
{
    Turning turn = { all(1), all(0), l2 == l2 };
    for (int k = 0; k < dome.count; k++)
    {
        const Sphere& face = dome.faces[k];
        const Lanes u2 = l2*(face.inverse*face.inverse), before2 = face.before2 - u2, after2 = face.after2 - u2;
        const Lanes before = sqrt(before2), after = sqrt(after2);
        const Lanes c = (before*after + u2)*face.inverseBoth;
        const Lanes s = (face.before2 - face.after2)*face.inverseBoth*face.inverse/(before + after);
        turn.good &= after2 > 0;
        turn = { turn.cosine*c - l2*turn.sine*s, turn.sine*c + turn.cosine*s, turn.good };
    }
    return turn;
}

/* With w the direction at the camera and d = cos w + (sin/l) L x w the one outside, S x d = Q L with Q = (sin/l) S.w - cos/n. The line
has the moment L/n' about S, so (1/n' + Q) L about the camera, and meets the axis through both, S = k a, at tau a with
tau = k (1 + 1/(n' Q)): regular along the axis, and where the camera is in the centre. */
bool traceOutDome(const Dome& dome, int n, const double* wx, const double* wy, const double* wz,
                  double* tau, double* dx, double* dy, double* dz)
{
    const Constants<3> center(dome.center);
    const double inner = dome.inner, inverseInner = 1/dome.inner, inverseOuter = 1/dome.outer, along = dome.along;
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Vector w = { load(wx, at), load(wy, at), load(wz, at) };
        const Vector S = { all(center[0]), all(center[1]), all(center[2]) }, W = cross(w, S);
        const Vector L = { inner*W.x, inner*W.y, inner*W.z }, across = cross(L, w);
        const Turning turn = turnBy(dome, dot(L, L));
        const Lanes Q = turn.sine*dot(center.value, w) - inverseInner*turn.cosine;
        store(answers.where(turn.good, along*(1 + inverseOuter/Q)), tau, at);
        store(turn.cosine*w.x + turn.sine*across.x, dx, at);
        store(turn.cosine*w.y + turn.sine*across.y, dy, at);
        store(turn.cosine*w.z + turn.sine*across.z, dz, at);
    });
    return answers.complete();
}

/* A point's direction: in the plane of camera, centre and point, Newton's method in the angle at the camera, from the straight
direction. The error is by how much the line outside misses the point, b x d - w l/n' with b = X - w S. */
struct DomeSearch
{
    Lanes length, weight;       //!< |X|, w of the point
    Lanes along, across;        //!< S along X, and across
    Lanes c, s;                 //!< the direction, along X and across it towards S; not quite unit
    Lanes step;
    Mask good;
};

inline void stepTowards(const Dome& dome, DomeSearch& search)
{
    const Lanes inverse = inverseSqrt(search.c*search.c + search.s*search.s), c = inverse*search.c, s = inverse*search.s;
    const Lanes l = dome.inner*(c*search.across - s*search.along), dl = -dome.inner*(c*search.along + s*search.across);
    Lanes dx = c, dy = s, slope = all(0);
    for (int k = 0; k < dome.count; k++)
    {
        const Sphere& face = dome.faces[k];
        const Lanes u = l*face.inverse, u2 = u*u, before = sqrt(face.before2 - u2), after = sqrt(face.after2 - u2);
        const Lanes product = before*after, difference = before - after;
        const Lanes cosine = (product + u2)*face.inverseBoth, sine = u*difference*face.inverseBoth, x = dx;
        slope += face.inverse*difference*roughInverse(product);
        dx = cosine*x - sine*dy;
        dy = cosine*dy + sine*x;
    }
    const Lanes bx = search.length - search.weight*search.along, by = -search.weight*search.across;
    const Lanes moment = search.weight*(1/dome.outer);
    const Lanes ahead = bx*dx + by*dy, miss = bx*dy - by*dx - moment*l, byAngle = ahead*(1 + slope*dl) - moment*dl;
    search.step = -miss*roughInverse(byAngle);
    search.c = c - search.step*s;
    search.s = s + search.step*c;
    search.good = (byAngle > 0) & (ahead > 0);
}

bool solveInDome(const Dome& given, int n, const double* px, const double* py, const double* pz, const double* pw,
                 double* dx, double* dy, double* dz)
{
    // What a step leaves is a few times its square.
    const double ENOUGH = 3e-9;
    const int STEPS = 10;
    const Dome dome = given;
    const double* const S = dome.center;
    const double radius2 = square(dome.faces[dome.count - 1].radius);
    Answers answers;
    eachGroup<DomeSearch>(n, [&](Group<DomeSearch>& group)
    {
        group.each([&](DomeSearch& search, Part at)
        {
            const Vector X = { load(px, at), load(py, at), load(pz, at) };
            const Lanes inverse = inverseSqrt(dot(X, X));
            search.weight = pw ? load(pw, at) : all(1);
            search.length = inverse*dot(X, X);
            search.along = inverse*dot(S, X);
            const Lanes k = inverse*search.along;
            const Vector across = { S[0] - k*X.x, S[1] - k*X.y, S[2] - k*X.z };
            search.across = sqrt(dot(across, across));
            search.c = all(1);
            search.s = all(0);
        });
        bool more = true;
        for (int k = 0; k < STEPS && more; k++)
        {
            group.each([&](DomeSearch& search, Part) { stepTowards(dome, search); });
            more = group.some([&](const DomeSearch& search) { return absolute(search.step) > ENOUGH; });
        }
        group.each([&](DomeSearch& search, Part at)
        {
            const Vector X = { load(px, at), load(py, at), load(pz, at) };
            const Lanes w = search.weight, length = search.length, bx = length - w*search.along, by = w*search.across;
            const Mask good = (bx*bx + by*by > w*w*radius2) & (absolute(search.step) <= ENOUGH) & search.good;
            const Lanes turn = select(search.across > 0, search.s*length/search.across, all(0));
            const Lanes k = search.c - turn*search.along/length;
            store(answers.where(good, k*X.x + turn*S[0]), dx, at);
            store(k*X.y + turn*S[1], dy, at);
            store(k*X.z + turn*S[2], dz, at);
        });
    });
    return answers.complete();
}

//! From where they are back to a face and through it. @param m its normal there
inline void passBack(const Dome& dome, const Sphere& face, RaysBeside& rays, Vector& m, Vector (&dm)[2])
{
    const double *S = dome.center, radius = face.radius;
    const Vector r = { rays.Q.x - S[0], rays.Q.y - S[1], rays.Q.z - S[2] };
    const Lanes b = dot(r, rays.p), over = dot(r, r) - radius*radius, rc = sqrt(b*b - face.after2*over);
    const Lanes s = over/(b + rc), c = rc*face.inverse, inverse = 1/c, before2 = c*c + (face.before2 - face.after2);
    const Lanes inverseBefore = inverseSqrt(before2), gamma = c - before2*inverseBefore;
    rays.Q = plus(rays.Q, -s, rays.p);
    m = { (rays.Q.x - S[0])*face.inverse, (rays.Q.y - S[1])*face.inverse, (rays.Q.z - S[2])*face.inverse };
    for (int j = 0; j < 2; j++)
    {
        const Vector moved = plus(rays.dQ[j], -s, rays.dp[j]);
        rays.ds[j] = dot(m, moved)*inverse;
        rays.dQ[j] = plus(moved, -rays.ds[j], rays.p);
        dm[j] = { rays.dQ[j].x*face.inverse, rays.dQ[j].y*face.inverse, rays.dQ[j].z*face.inverse };
        rays.dGamma[j] = (dot(m, rays.dp[j]) + dot(dm[j], rays.p))*(1 - c*inverseBefore);
        rays.dp[j] = plus(plus(rays.dp[j], -rays.dGamma[j], m), -gamma, dm[j]);
    }
    rays.p = plus(rays.p, -gamma, m);
    rays.gamma = gamma;
}

/** The two rays' changes of all parameters, as rows 0 and 1 of byWindow; with no byWindow they are only followed.
@return how the rays' origin moves with each */
template<typename At>
inline void followBack(const Dome& dome, const Columns& byWindow, At at, RaysBeside& rays, Vector (&dO)[2])
{
    const WindowLayout& column = dome.at;
    const auto put = [&](int c, Lanes first, Lanes second)
    {
        storeAt(first, byWindow, 0, c, at);
        storeAt(second, byWindow, 1, c, at);
    };
    const Lanes zero = all(0);
    Lanes byRadius[2] = { zero, zero };
    Vector m, dm[2], byCenter[2] = { { zero, zero, zero }, { zero, zero, zero } };
    for (int k = dome.count - 1; k >= 0; k--)
    {
        const Sphere& face = dome.faces[k];
        passBack(dome, face, rays, m, dm);
        if (!byWindow.data)
            continue;
        put(k == dome.count - 1 ? column.outerIndex : column.index + k, face.after*rays.ds[0], face.after*rays.ds[1]);
        for (int j = 0; j < 2; j++)
        {
            byRadius[j] -= rays.dGamma[j];
            byCenter[j] = plus(plus(byCenter[j], -rays.dGamma[j], m), -rays.gamma, dm[j]);
        }
        put(k == 0 ? column.distance : column.thickness + k - 1, byRadius[0], byRadius[1]);
    }
    arriveAt(dot(rays.Q, rays.p)*(1/(dome.inner*dome.inner)), dome.inner, rays, dO);
    if (!byWindow.data)
        return;
    put(column.innerIndex, dome.inner*rays.ds[0], dome.inner*rays.ds[1]);
    put(column.normal, byCenter[0].x, byCenter[1].x);
    put(column.normal + 1, byCenter[0].y, byCenter[1].y);
    put(column.normal + 2, byCenter[0].z, byCenter[1].z);
}

/** Rays from X, or where X is far compared with the dome from where they leave it: the way back from X would be a difference of large
numbers. @param L of the ray */
inline RaysBeside raysFrom(const Dome& dome, const Vector& X, const Vector& p, const Vector& L)
{
    const double FAR2 = 1e8, *S = dome.center, radius2 = square(dome.faces[dome.count - 1].radius), inverse2 = 1/square(dome.outer);
    RaysBeside rays;
    beginAt(X, p, dome.outer, rays);
    const Vector b = { X.x - S[0], X.y - S[1], X.z - S[2] };
    const Mask isFar = dot(b, b) > FAR2*radius2;
    if (!any(isFar))
        return rays;
    const Vector foot = cross(p, L);        // times outer^2, of the line outside, from S
    const Lanes ahead = sqrt(radius2 - dot(foot, foot)*(inverse2*inverse2))*(1/dome.outer);
    const Vector r = plus({ foot.x*inverse2, foot.y*inverse2, foot.z*inverse2 }, ahead, p), P = plus(r, all(1), S);
    const Lanes s = select(isFar, dot(p, plus(b, all(-1), r))*inverse2, all(0));
    rays.Q = { select(isFar, P.x, X.x), select(isFar, P.y, X.y), select(isFar, P.z, X.z) };
    for (int j = 0; j < 2; j++)
        rays.dQ[j] = { -s*rays.dp[j].x, -s*rays.dp[j].y, -s*rays.dp[j].z };
    return rays;
}

//! Rows D by the direction -> by the point and by the dome; two rows at least.
void chainDome(const Dome& dome, int rows, int n, const double* px, const double* py, const double* pz,
               const double* pdx, const double* pdy, const double* pdz, const Columns& byDirection, const Columns& byPoint,
               const Columns& byWindow)
{
    const double* const S = dome.center;
    eachRegister(n, [&](auto at)
    {
        const Vector d = { load(pdx, at), load(pdy, at), load(pdz, at) };
        const Lanes scale = dome.inner*inverseSqrt(dot(d, d)), out = all(dome.outer);
        const Vector p = { scale*d.x, scale*d.y, scale*d.z };
        const Vector L = cross(p, { all(S[0]), all(S[1]), all(S[2]) }), across = cross(L, p);
        const Turning turn = turnBy(dome, dot(L, L));
        const Lanes c = turn.cosine*out*(1/dome.inner), s = turn.sine*out*(1/dome.inner);
        RaysBeside rays = raysFrom(dome, { load(px, at), load(py, at), load(pz, at) },
                                   { c*p.x + s*across.x, c*p.y + s*across.y, c*p.z + s*across.z }, L);
        const Vector atPoint[2] = { rays.dp[0], rays.dp[1] };
        Vector dO[2];
        followBack(dome, byWindow, at, rays, dO);
        chainRows(rows, byWindow.data ? dome.at.count : 0, dO, atPoint, p, scale,
                  [&](int row) { return loadRow(byDirection, row, at); }, byPoint, byWindow, at);
    });
}

constexpr DomeKernels domeTable = { traceOutDome, solveInDome, chainDome };

}}} // namespace

#endif // OPENCV_REFRACT_DOME_SIMD_HPP
