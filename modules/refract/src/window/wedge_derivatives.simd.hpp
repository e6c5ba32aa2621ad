// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_WEDGE_DERIVATIVES_SIMD_HPP
#define OPENCV_REFRACT_WEDGE_DERIVATIVES_SIMD_HPP

#include "window/layers.simd.hpp"
#include "window/rays_beside.simd.hpp"
#include "window/wedge_kernels.hpp"

/* How the direction in which the camera sees a point moves with faces that are not parallel, see rays_beside.simd.hpp. */

namespace cv { namespace refract { namespace {

//! From where they are back to a face and through it.
inline void passBack(const Face& face, RaysBeside& rays)
{
    const double* const m = face.normal;
    const Lanes c = dot(m, rays.p), inverse = 1/c, s = (dot(m, rays.Q) - face.distance)*inverse;
    const Lanes before2 = c*c - face.excess, inverseBefore = inverseSqrt(before2), gamma = c - before2*inverseBefore;
    for (int j = 0; j < 2; j++)
    {
        const Vector moved = plus(rays.dQ[j], -s, rays.dp[j]);
        rays.ds[j] = dot(m, moved)*inverse;
        rays.dQ[j] = plus(moved, -rays.ds[j], rays.p);
        rays.dGamma[j] = dot(m, rays.dp[j])*(1 - c*inverseBefore);
        rays.dp[j] = plus(rays.dp[j], -rays.dGamma[j], m);
    }
    rays.Q = plus(rays.Q, -s, rays.p);
    rays.p = plus(rays.p, -gamma, m);
    rays.gamma = gamma;
}

//! A sum over the faces of gamma (dm.P - d distance), as the two rays change it.
struct FaceSum
{
    Lanes by[2] = { all(0), all(0) };
    void add(const RaysBeside& rays, const double* dm, double dDistance)
    {
        for (int j = 0; j < 2; j++)
            by[j] += rays.dGamma[j]*(dot(dm, rays.Q) - dDistance) + rays.gamma*dot(dm, rays.dQ[j]);
    }
};

//! The optical vector behind the last face, from that at the camera.
inline Vector behindWindow(const TiltedFaces& window, Vector p)
{
    for (int k = 0; k < window.count; k++)
    {
        const Face& face = window.faces[k];
        const Lanes c = dot(face.normal, p), after2 = c*c + face.excess;
        p = plus(p, after2*inverseSqrt(after2) - c, face.normal);
    }
    return p;
}

/** The two rays' changes of all parameters, as rows 0 and 1 of byWindow; with no byWindow they are only followed.
@return how the rays' origin moves with each */
template<typename At>
inline void followBack(const TiltedFaces& window, const Columns& byWindow, At at, RaysBeside& rays, Vector (&dO)[2])
{
    const WindowLayout& column = window.at;
    const bool isWanted = byWindow.data != nullptr;
    const auto put = [&](int c, Lanes first, Lanes second)
    {
        storeAt(first, byWindow, 0, c, at);
        storeAt(second, byWindow, 1, c, at);
    };
    const double none[3] = { 0, 0, 0 };
    FaceSum height, lean[2], turn[2];
    for (int k = window.count - 1; k >= 0; k--)
    {
        const Face& face = window.faces[k];
        passBack(face, rays);
        if (!isWanted)
            continue;
        put(k == window.count - 1 ? column.outerIndex : column.index + k, face.after*rays.ds[0], face.after*rays.ds[1]);
        height.add(rays, none, face.byHeight);
        put(k == 0 ? column.distance : column.thickness + k - 1, height.by[0], height.by[1]);
        for (int a = 0; a < 2; a++)
        {
            turn[a].add(rays, face.byTurn[a], 0);
            lean[a].add(rays, face.byLean[a], face.distanceByLean[a]);
            if (k > 0)
                put(column.wedge + 2*(k - 1) + a, lean[a].by[0], lean[a].by[1]);
        }
    }
    arriveAt(rays.Q.z/rays.p.z, window.inner, rays, dO);
    if (!isWanted)
        return;
    Vector byNormal[2];
    for (int j = 0; j < 2; j++)
        byNormal[j] = outOfFrame(window.axes, { turn[0].by[j], turn[1].by[j], all(0) });
    put(column.innerIndex, window.inner*rays.ds[0], window.inner*rays.ds[1]);
    put(column.normal, byNormal[0].x, byNormal[1].x);
    put(column.normal + 1, byNormal[0].y, byNormal[1].y);
    put(column.normal + 2, byNormal[0].z, byNormal[1].z);
}

//! Rows D by the direction -> by the point and by the window; two rows at least.
void chainWedge(const TiltedFaces& window, int rows, int n, const double* px, const double* py, const double* pz,
                const double* pdx, const double* pdy, const double* pdz, const Columns& byDirection, const Columns& byPoint,
                const Columns& byWindow)
{
    const Constants<9> axes(window.axes);
    eachRegister(n, [&](auto at)
    {
        const Vector d = intoFrame(axes.value, { load(pdx, at), load(pdy, at), load(pdz, at) });
        const Lanes scale = window.inner*inverseSqrt(dot(d, d));
        RaysBeside rays;
        beginAt(intoFrame(axes.value, { load(px, at), load(py, at), load(pz, at) }),
                behindWindow(window, { scale*d.x, scale*d.y, scale*d.z }), window.outer, rays);
        const Vector atPoint[2] = { outOfFrame(axes.value, rays.dp[0]), outOfFrame(axes.value, rays.dp[1]) };
        Vector dO[2];
        followBack(window, byWindow, at, rays, dO);
        chainRows(rows, byWindow.data ? window.at.count : 0, dO, atPoint, rays.p, scale,
                  [&](int row) { return intoFrame(axes.value, loadRow(byDirection, row, at)); }, byPoint, byWindow, at);
    });
}

}}} // namespace

#endif // OPENCV_REFRACT_WEDGE_DERIVATIVES_SIMD_HPP
