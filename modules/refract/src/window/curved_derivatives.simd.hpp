// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CURVED_DERIVATIVES_SIMD_HPP
#define OPENCV_REFRACT_CURVED_DERIVATIVES_SIMD_HPP

#include "window/curved_kernels.hpp"
#include "window/wedge.simd.hpp"

/* Where light crosses a curved face, see curved.simd.hpp; and how the direction in which the camera sees a point moves with a tube or
a bent pane, see rays_beside.simd.hpp. A face Q(X) = distance moves by -dQ along its normal where a parameter changes Q - distance by
dQ there, so that V changes by

    dV = sum over the media of s n dn + sum over the faces of gamma dQ(P) */

namespace cv { namespace refract { namespace {

//! K a, of a curvature.
inline Vector bentBy(double curvature, double third, const Vector& a)
{
    return { curvature*a.x, curvature*a.y, (curvature*third)*a.z };
}

/** As that of a Surface, of the last face: times w. A sphere with its centre in the scene may hide X in more than one way; there it
counts that the ray to X has passed the face. */
inline Mask isBeyond(double third, const CurvedFace& last, const Vector& X, Lanes w)
{
    const Lanes level = dot(last.gradient, X);
    Mask beyond = w*level + 0.5*dot(X, bentBy(last.curvature, third, X)) > w*w*last.distance;
    if (last.curvature < 0)
        beyond |= w == w;
    return beyond;
}

//! A bent pane is a pane to the directions in front of it only.
inline Mask leavesCamera(const CurvedFaces& window, const Vector& d)
{
    return window.third == 0 ? d.x*d.x + d.y*d.y > (ALONG_AXIS*ALONG_AXIS)*dot(d, d) : d.z > 0;
}

struct Crossing
{
    Lanes s;                        //!< at P + s p; less than 0 for a face before P
    Lanes c, c2;                    //!< m.p there, and its square: below 0 where the line does not meet the face
    Vector m;                       //!< the normal there
};

inline Crossing crossingOf(double third, const CurvedFace& face, const Vector& P, const Vector& p)
{
    const Vector KP = bentBy(face.curvature, third, P), Kp = bentBy(face.curvature, third, p);
    const Vector slope = { face.gradient[0] + KP.x, face.gradient[1] + KP.y, face.gradient[2] + KP.z };
    const Lanes b = dot(slope, p), ahead = face.distance - dot(face.gradient, P) - 0.5*dot(P, KP), bend = dot(p, Kp);
    Crossing hit;
    hit.c2 = b*b + 2*bend*ahead;
    hit.c = sqrt(hit.c2);
    // Twice the same; each without cancellation on its side.
    hit.s = select(b > 0, 2*ahead, hit.c - b)/select(b > 0, b + hit.c, bend);
    hit.m = plus(slope, hit.s, Kp);
    return hit;
}

//! From where they are back to a face and through it. @param m its normal there, as the rays change it: dm
inline void passBack(double third, const CurvedFace& face, RaysBeside& rays, Vector& m, Vector (&dm)[2])
{
    const Crossing hit = crossingOf(third, face, rays.Q, rays.p);
    const Lanes before2 = hit.c2 - face.excess, inverseBefore = inverseSqrt(before2), gamma = hit.c - before2*inverseBefore;
    const Lanes inverse = 1/hit.c;
    m = hit.m;
    rays.Q = plus(rays.Q, hit.s, rays.p);
    for (int j = 0; j < 2; j++)
    {
        const Vector moved = plus(rays.dQ[j], hit.s, rays.dp[j]);
        rays.ds[j] = dot(m, moved)*inverse;
        rays.dQ[j] = plus(moved, -rays.ds[j], rays.p);
        dm[j] = bentBy(face.curvature, third, rays.dQ[j]);
        rays.dGamma[j] = (dot(m, rays.dp[j]) + dot(dm[j], rays.p))*(1 - hit.c*inverseBefore);
        rays.dp[j] = plus(plus(rays.dp[j], -rays.dGamma[j], m), -gamma, dm[j]);
    }
    rays.p = plus(rays.p, -gamma, m);
    rays.gamma = gamma;
}

//! The two rays' changes of a tube's parameters but the indices.
template<typename At>
struct TubeSums
{
    const CurvedFaces& window;
    const Columns& byWindow;
    At at;
    Vector byCenter[2], byAxis[2];
    Lanes byRadius[2];

    TubeSums(const CurvedFaces& window_, const Columns& byWindow_, At at_) : window(window_), byWindow(byWindow_), at(at_)
    {
        const Lanes zero = all(0);
        byCenter[0] = byCenter[1] = byAxis[0] = byAxis[1] = { zero, zero, zero };
        byRadius[0] = byRadius[1] = zero;
    }
    //! A turn of the axis moves a face along m by as much as P is up the axis from the center.
    void add(int k, const RaysBeside& rays, const Vector& m, const Vector (&dm)[2])
    {
        const Lanes up = rays.Q.z - window.center[2];
        for (int j = 0; j < 2; j++)
        {
            const Lanes dUp = rays.gamma*rays.dQ[j].z + rays.dGamma[j]*up;
            byRadius[j] -= rays.dGamma[j];
            byCenter[j] = plus(plus(byCenter[j], -rays.dGamma[j], m), -rays.gamma, dm[j]);
            byAxis[j] = plus(plus(byAxis[j], -dUp, m), -rays.gamma*up, dm[j]);
            storeAt(byRadius[j], byWindow, j, k == 0 ? window.at.distance : window.at.thickness + k - 1, at);
        }
    }
    void finish()
    {
        for (int j = 0; j < 2; j++)
        {
            putVector(outOfFrame(window.axes, byCenter[j]), j, window.at.normal);
            putVector(outOfFrame(window.axes, byAxis[j]), j, window.at.axis);
        }
    }
    void putVector(const Vector& a, int row, int column)
    {
        storeAt(a.x, byWindow, row, column, at);
        storeAt(a.y, byWindow, row, column + 1, at);
        storeAt(a.z, byWindow, row, column + 2, at);
    }
};

//! The same of a bent pane. With Y = P from where the face meets the axis, Q = m.Y + curvature/2 |Y|^2.
template<typename At>
struct BentSums
{
    const CurvedFaces& window;
    const Columns& byWindow;
    At at;
    FaceSum lean[2], turn[2];
    Lanes byHeight[2], byLayer[2], byCurvature[2];      //!< byLayer: what the curvature of outer faces adds to byHeight

    BentSums(const CurvedFaces& window_, const Columns& byWindow_, At at_) : window(window_), byWindow(byWindow_), at(at_)
    {
        byHeight[0] = byHeight[1] = byLayer[0] = byLayer[1] = byCurvature[0] = byCurvature[1] = all(0);
    }
    void add(int k, const RaysBeside& rays, const Vector& m, const Vector (&dm)[2])
    {
        const CurvedFace& face = window.faces[k];
        const Face& tangent = window.tangents[k];
        const WindowLayout& column = window.at;
        const Vector Y = { rays.Q.x, rays.Q.y, rays.Q.z - face.height };
        const Lanes half = 0.5*dot(Y, Y);
        for (int j = 0; j < 2; j++)
        {
            const Lanes bend = rays.dGamma[j]*half + rays.gamma*dot(Y, rays.dQ[j]);
            byHeight[j] -= rays.dGamma[j]*m.z + rays.gamma*dm[j].z;
            byLayer[j] -= face.curvature*face.curvature*bend;
            byCurvature[j] += face.byCurvature*bend;
            storeAt(k == 0 ? byHeight[j] : byHeight[j] + byLayer[j], byWindow, j, k == 0 ? column.distance : column.thickness + k - 1, at);
        }
        for (int a = 0; a < 2; a++)
        {
            double byTurn[3] = { tangent.byTurn[a][0], tangent.byTurn[a][1], tangent.byTurn[a][2] };
            byTurn[a] -= face.curvature*face.height;
            turn[a].add(rays, byTurn, 0);
            lean[a].add(rays, tangent.byLean[a], tangent.distanceByLean[a]);
            for (int j = 0; j < 2 && k > 0 && column.curvature > column.wedge; j++)
                storeAt(lean[a].by[j], byWindow, j, column.wedge + 2*(k - 1) + a, at);
        }
    }
    void finish()
    {
        for (int j = 0; j < 2; j++)
        {
            const Vector byNormal = outOfFrame(window.axes, { turn[0].by[j], turn[1].by[j], all(0) });
            storeAt(byNormal.x, byWindow, j, window.at.normal, at);
            storeAt(byNormal.y, byWindow, j, window.at.normal + 1, at);
            storeAt(byNormal.z, byWindow, j, window.at.normal + 2, at);
            storeAt(byCurvature[j], byWindow, j, window.at.curvature, at);
        }
    }
};

/** The two rays' changes of all parameters, as rows 0 and 1 of byWindow; with no byWindow they are only followed.
@return how the rays' origin moves with each */
template<typename Sums, typename At>
inline void followBack(const CurvedFaces& window, const Columns& byWindow, At at, RaysBeside& rays, Vector (&dO)[2])
{
    const WindowLayout& column = window.at;
    const auto put = [&](int c, double index)
    {
        for (int j = 0; j < 2; j++)
            storeAt(index*rays.ds[j], byWindow, j, c, at);
    };
    Sums sums(window, byWindow, at);
    for (int k = window.count - 1; k >= 0; k--)
    {
        Vector m, dm[2];
        passBack(window.third, window.faces[k], rays, m, dm);
        if (!byWindow.data)
            continue;
        put(k == window.count - 1 ? column.outerIndex : column.index + k, window.faces[k].after);
        sums.add(k, rays, m, dm);
    }
    arriveAt(dot(rays.Q, rays.p)*(1/(window.inner*window.inner)), window.inner, rays, dO);
    if (!byWindow.data)
        return;
    put(column.innerIndex, window.inner);
    sums.finish();
}

//! The ray of a direction at the camera, of optical vector p, where it passes the last face, and its vector behind it.
inline Vector passAll(const CurvedFaces& window, Vector& p)
{
    Vector P = { all(0), all(0), all(0) };
    for (int k = 0; k < window.count; k++)
    {
        const Crossing hit = crossingOf(window.third, window.faces[k], P, p);
        const Lanes after2 = hit.c2 + window.faces[k].excess;
        P = plus(P, hit.s, p);
        p = plus(p, after2*inverseSqrt(after2) - hit.c, hit.m);
    }
    return P;
}

/** Rows D by the direction -> by the point and by the window; two rows at least. From a point that is far compared with a face's
radius the way back to it is a difference of large numbers, so the rays begin where the way out has met the last face. */
template<typename At, template<typename> class Sums>
inline void chainThrough(const CurvedFaces& window, int rows, const Vector& X, const Vector& d, const Columns& byDirection,
                         const Columns& byPoint, const Columns& byWindow, At at)
{
    const Lanes scale = window.inner*inverseSqrt(dot(d, d));
    Vector p = { scale*d.x, scale*d.y, scale*d.z };
    const Vector P = passAll(window, p);
    const Lanes s = dot(p, plus(X, all(-1), P))*(1/(window.outer*window.outer));
    RaysBeside rays;
    beginAt(P, p, window.outer, rays);
    for (int j = 0; j < 2; j++)
        rays.dQ[j] = { -s*rays.dp[j].x, -s*rays.dp[j].y, -s*rays.dp[j].z };
    const Vector atPoint[2] = { outOfFrame(window.axes, rays.dp[0]), outOfFrame(window.axes, rays.dp[1]) };
    Vector dO[2];
    followBack<Sums<At> >(window, byWindow, at, rays, dO);
    chainRows(rows, byWindow.data ? window.at.count : 0, dO, atPoint, rays.p, scale,
              [&](int row) { return intoFrame(window.axes, loadRow(byDirection, row, at)); }, byPoint, byWindow, at);
}

void chainCurved(const CurvedFaces& given, int rows, int n, const double* px, const double* py, const double* pz,
                 const double* pdx, const double* pdy, const double* pdz, const Columns& byDirection, const Columns& byPoint,
                 const Columns& byWindow)
{
    const CurvedFaces window = given;
    eachRegister(n, [&](auto at)
    {
        const Vector X = intoFrame(window.axes, { load(px, at), load(py, at), load(pz, at) });
        const Vector d = intoFrame(window.axes, { load(pdx, at), load(pdy, at), load(pdz, at) });
        if (window.third == 0)
            chainThrough<decltype(at), TubeSums>(window, rows, X, d, byDirection, byPoint, byWindow, at);
        else
            chainThrough<decltype(at), BentSums>(window, rows, X, d, byDirection, byPoint, byWindow, at);
    });
}

}}} // namespace

#endif // OPENCV_REFRACT_CURVED_DERIVATIVES_SIMD_HPP
