// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SURFACE_HPP
#define OPENCV_REFRACT_SURFACE_HPP

#include "simd/lanes.hpp"

/* The last surface of a window, which is all that others need to know of its shape. No OpenCV in here, see dispatch/kernels.hpp. */

namespace cv { namespace refract {

/** Points X with normal.X + curvature/2 |X|^2 = distance: a plane of unit normal, or a sphere of radius 1/curvature about
-normal/curvature; with a unit axis a, |X|^2 less (a.X)^2: a circular cylinder. The scene is where the left side is larger. Where
the curvature is negative the sphere's centre is in the scene: light goes through the part of the sphere that the camera sees, and
what lies behind the sphere is beyond the surface, too. */
struct Surface
{
    double normal[3], distance, curvature;
    double axis[3];             //!< 0: a plane or a sphere
    double camera[3];           //!< where that is
};

namespace {

inline bool hasAxis(const Surface& s) { return s.axis[0] != 0 || s.axis[1] != 0 || s.axis[2] != 0; }

//! a.b, of a cylinder without what is along its axis.
template<typename T>
inline T dotAcross(const Surface& s, T ax, T ay, T az, T bx, T by, T bz)
{
    T product = ax*bx + ay*by + az*bz;
    if (hasAxis(s))
        product -= (s.axis[0]*ax + s.axis[1]*ay + s.axis[2]*az)*(s.axis[0]*bx + s.axis[1]*by + s.axis[2]*bz);
    return product;
}

//! Where the left side is larger, of homogeneous points; infinitely far ones are beyond every sphere about the camera.
template<typename T>
inline auto isOnSceneSide(const Surface& s, T x, T y, T z, T w)
{
    T along = s.normal[0]*x + s.normal[1]*y + s.normal[2]*z;
    if (s.curvature != 0)
        along += 0.5*s.curvature*dotAcross(s, x, y, z, x, y, z)/w;
    return along > w*s.distance;
}

/* With Q(X) = normal.X + curvature/2 |X|^2 - distance and B its bilinear form, the straight way from the camera C to X meets the sphere
where B(C, C) + 2 s B(C, X) + s^2 B(X, X) has a root s > 0. */

//! Of homogeneous points. Behind a sphere with its centre in the scene they are where it hides them from the camera.
template<typename T>
inline auto isBeyond(const Surface& s, T x, T y, T z, T w)
{
    auto beyond = isOnSceneSide(s, x, y, z, w);
    if (s.curvature < 0)
    {
        const double* const C = s.camera;
        const double atC = s.normal[0]*C[0] + s.normal[1]*C[1] + s.normal[2]*C[2];
        const double own = atC + 0.5*s.curvature*(C[0]*C[0] + C[1]*C[1] + C[2]*C[2]) - s.distance;
        const T level = s.normal[0]*x + s.normal[1]*y + s.normal[2]*z;
        const T both = 0.5*(level + w*atC + s.curvature*(C[0]*x + C[1]*y + C[2]*z)) - w*s.distance;
        const T other = w*(level - w*s.distance) + 0.5*s.curvature*(x*x + y*y + z*z);
        beyond |= (both > 0) & (both*both >= own*other);
    }
    return beyond;
}

//! Of a point of a line that goes out along d: beyond where it goes out, and not where it comes in or has not come to the surface yet.
template<typename T>
inline auto isBeyondAlong(const Surface& s, T x, T y, T z, T w, T dx, T dy, T dz)
{
    auto beyond = isOnSceneSide(s, x, y, z, w);
    if (s.curvature == 0)
        return beyond;
    const T slope = w*(s.normal[0]*dx + s.normal[1]*dy + s.normal[2]*dz) + s.curvature*dotAcross(s, x, y, z, dx, dy, dz);
    if (s.curvature > 0)
        beyond &= slope > 0;
    else        // along a line into a sphere Q rises and falls again
        beyond |= slope <= 0;
    return beyond;
}

//! The s at which the line o + s d, of unit d, goes out.
template<typename T>
inline T lengthTo(const Surface& s, T ox, T oy, T oz, T dx, T dy, T dz)
{
    T height = s.distance - (s.normal[0]*ox + s.normal[1]*oy + s.normal[2]*oz);
    T slope = s.normal[0]*dx + s.normal[1]*dy + s.normal[2]*dz;
    if (s.curvature != 0)
    {
        height -= 0.5*s.curvature*dotAcross(s, ox, oy, oz, ox, oy, oz);
        slope += s.curvature*dotAcross(s, ox, oy, oz, dx, dy, dz);
        T bend = 2*s.curvature*height;
        if (hasAxis(s))
            bend *= dotAcross(s, dx, dy, dz, dx, dy, dz);
        const T root2 = slope*slope + bend;
        slope = 0.5*(slope + root2*inverseSqrt(root2));
    }
    return height/slope;
}

//! Its normal at a point of it, of any length.
inline void gradientAt(const Surface& s, double x, double y, double z, double* m)
{
    const double along = s.axis[0]*x + s.axis[1]*y + s.axis[2]*z;
    m[0] = s.normal[0] + s.curvature*(x - along*s.axis[0]);
    m[1] = s.normal[1] + s.curvature*(y - along*s.axis[1]);
    m[2] = s.normal[2] + s.curvature*(z - along*s.axis[2]);
}

//! In the frame of X, where X' = R X + t is that of the surface.
inline Surface inFrame(const Surface& s, const double* R, const double* t)
{
    double m[3];
    gradientAt(s, t[0], t[1], t[2], m);
    const double along = s.axis[0]*t[0] + s.axis[1]*t[1] + s.axis[2]*t[2];
    Surface moved = { { 0, 0, 0 }, s.distance + 0.5*s.curvature*along*along, s.curvature, { 0, 0, 0 }, { 0, 0, 0 } };
    const double away[3] = { s.camera[0] - t[0], s.camera[1] - t[1], s.camera[2] - t[2] };
    for (int k = 0; k < 3; k++)
    {
        moved.camera[k] = R[k]*away[0] + R[3 + k]*away[1] + R[6 + k]*away[2];
        moved.normal[k] = R[k]*m[0] + R[3 + k]*m[1] + R[6 + k]*m[2];
        moved.axis[k] = R[k]*s.axis[0] + R[3 + k]*s.axis[1] + R[6 + k]*s.axis[2];
        moved.distance -= (s.normal[k] + 0.5*s.curvature*t[k])*t[k];
    }
    return moved;
}

}}} // namespace

#endif // OPENCV_REFRACT_SURFACE_HPP
