// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RAYS_BESIDE_SIMD_HPP
#define OPENCV_REFRACT_RAYS_BESIDE_SIMD_HPP

#include "simd/vectors.hpp"

/* How the direction in which the camera sees a point moves with all that there is, for faces of any shape. With the optical vector
p = index * direction, V is the optical length of the path from O to X: p = -dV/dO at the camera, and what moves a face or an index
moves V as if the path stayed where it is,

    dV = sum over the media of s n dn - sum over the faces of gamma (how far the face moves along its normal m at P)

with P' = P + s p from one face to the next and p' = p + gamma m there. So D.dp = -(D.d/dO) dV, the change of these terms and, by
X, of the vector p there, when O moves by D and X stays. Two rays through X beside the ray's own say how: they are followed back to
the camera, which tells by how much of each of them O moves by D. */

namespace cv { namespace refract { namespace {

//! a + k b
inline Vector plus(const Vector& a, Lanes k, const Vector& b) { return { a.x + k*b.x, a.y + k*b.y, a.z + k*b.z }; }
inline Vector plus(const Vector& a, Lanes k, const double* b) { return { a.x + k*b[0], a.y + k*b[1], a.z + k*b[2] }; }

struct RaysBeside
{
    Vector Q, p;                //!< where the ray is, and its optical vector
    Vector dQ[2], dp[2];        //!< of the two beside it
    Lanes gamma, dGamma[2];     //!< at the last face passed
    Lanes ds[2];                //!< of the way back to it
};

//! At X, with the ray's optical vector there.
inline void beginAt(const Vector& X, const Vector& p, double index, RaysBeside& rays)
{
    const Lanes zero = all(0), inverse = all(1/index);
    rays.Q = X;
    rays.p = p;
    vectorsAcross({ inverse*p.x, inverse*p.y, inverse*p.z }, rays.dp[0], rays.dp[1]);
    rays.dQ[0] = rays.dQ[1] = { zero, zero, zero };
}

//! How the rays' origin moves with each of them; the camera is s behind.
inline void arriveAt(Lanes s, double index, RaysBeside& rays, Vector (&dO)[2])
{
    for (int j = 0; j < 2; j++)
    {
        rays.ds[j] = dot(rays.p, rays.dQ[j])*(1/(index*index));
        dO[j] = plus(plus(rays.dQ[j], -s, rays.dp[j]), -rays.ds[j], rays.p);
    }
}

/** Rows D by the direction -> by the point, and by the window, of which rows 0 and 1 of byWindow are the two rays' changes. D, along
the unit direction 0, is a sum of what O moves by with each ray: both are across p.
@param atPoint the two rays' vectors at X. @param p at the camera, over `scale` the direction that D is by
@param loadD D of a row; all in the frame of dO */
template<typename At, typename LoadRow>
inline void chainRows(int rows, int columns, const Vector (&dO)[2], const Vector (&atPoint)[2], const Vector& p, Lanes scale,
                      const LoadRow& loadD, const Columns& byPoint, const Columns& byWindow, At at)
{
    enum { MOST_ROWS = 3 };
    const Vector across1 = cross(dO[1], p), across2 = cross(p, dO[0]);
    const Lanes factor = -1/(scale*dot(dO[0], across1));
    Lanes share[MOST_ROWS][2];
    for (int row = 0; row < rows; row++)
    {
        const Vector D = loadD(row);
        const Lanes a = share[row][0] = dot(D, across1)*factor, b = share[row][1] = dot(D, across2)*factor;
        storeAt(a*atPoint[0].x + b*atPoint[1].x, byPoint, row, 0, at);
        storeAt(a*atPoint[0].y + b*atPoint[1].y, byPoint, row, 1, at);
        storeAt(a*atPoint[0].z + b*atPoint[1].z, byPoint, row, 2, at);
    }
    for (int column = 0; column < columns; column++)
    {
        const Lanes first = load(byWindow.at(0, column), at), second = load(byWindow.at(1, column), at);
        for (int row = 0; row < rows; row++)
            storeAt(share[row][0]*first + share[row][1]*second, byWindow, row, column, at);
    }
}

}}} // namespace

#endif // OPENCV_REFRACT_RAYS_BESIDE_SIMD_HPP
