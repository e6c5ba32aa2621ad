// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SURFACE_HPP
#define OPENCV_REFRACT_SURFACE_HPP

#include "simd/lanes.hpp"

/* The last surface of a window, which is all that others need to know of its shape. No OpenCV in here, see dispatch/kernels.hpp. */

namespace cv { namespace refract {

/** Points X with normal.X + curvature/2 |X|^2 = distance: a plane of unit normal, or a sphere of radius 1/curvature about
-normal/curvature. The scene is where the left side is larger. */
struct Surface
{
    double normal[3], distance, curvature;
};

namespace {

//! Of homogeneous points; infinitely far ones are beyond every sphere.
template<typename T>
inline auto isBeyond(const Surface& s, T x, T y, T z, T w)
{
    T along = s.normal[0]*x + s.normal[1]*y + s.normal[2]*z;
    if (s.curvature > 0)
        along += 0.5*s.curvature*(x*x + y*y + z*z)/w;
    return along > w*s.distance;
}

//! The s at which the line o + s d, of unit d, goes out.
template<typename T>
inline T lengthTo(const Surface& s, T ox, T oy, T oz, T dx, T dy, T dz)
{
    T height = s.distance - (s.normal[0]*ox + s.normal[1]*oy + s.normal[2]*oz);
    T slope = s.normal[0]*dx + s.normal[1]*dy + s.normal[2]*dz;
    if (s.curvature > 0)
    {
        height -= 0.5*s.curvature*(ox*ox + oy*oy + oz*oz);
        slope += s.curvature*(ox*dx + oy*dy + oz*dz);
        const T root2 = slope*slope + 2*s.curvature*height;
        slope = 0.5*(slope + root2*inverseSqrt(root2));
    }
    return height/slope;
}

//! Its normal at a point of it, of any length.
inline void gradientAt(const Surface& s, double x, double y, double z, double* m)
{
    m[0] = s.normal[0] + s.curvature*x;
    m[1] = s.normal[1] + s.curvature*y;
    m[2] = s.normal[2] + s.curvature*z;
}

//! In the frame of X, where X' = R X + t is that of the surface.
inline Surface inFrame(const Surface& s, const double* R, const double* t)
{
    double m[3];
    gradientAt(s, t[0], t[1], t[2], m);
    Surface moved = { { 0, 0, 0 }, s.distance, s.curvature };
    for (int k = 0; k < 3; k++)
    {
        moved.normal[k] = R[k]*m[0] + R[3 + k]*m[1] + R[6 + k]*m[2];
        moved.distance -= (s.normal[k] + 0.5*s.curvature*t[k])*t[k];
    }
    return moved;
}

}}} // namespace

#endif // OPENCV_REFRACT_SURFACE_HPP
