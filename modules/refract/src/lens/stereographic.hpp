// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_STEREOGRAPHIC_HPP
#define OPENCV_REFRACT_STEREOGRAPHIC_HPP

#include "precomp.hpp"
#include "lens/stereographic_model.hpp"

/* The stereographic projection 2 tan(theta/2) (X, Y)/|(X, Y)| = 2 (X, Y)/(|d| + Z) and its inverse. */

namespace cv { namespace refract {

/** One direction of any length; its derivatives may be null. Only straight backwards has no image. */
inline uchar stereographic(const Vec3d& d, Vec2d& plane, Matx23d* byDirection)
{
    const double r2 = d[0]*d[0] + d[1]*d[1], length = std::sqrt(r2 + d[2]*d[2]);
    const double w = stereographicDivisor(r2, length, d[2]);
    plane = Vec2d(d[0], d[1])*(2/w);
    if (byDirection)
    {
        const Vec3d slope = Vec3d(d[0], d[1], w)*(1/(length*w));
        for (int row = 0; row < 2; row++)
            for (int c = 0; c < 3; c++)
                (*byDirection)(row, c) = (row == c ? 2/w : 0) - plane[row]*slope[c];
    }
    return w > 0 ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
}

//! The unit direction.
inline Vec3d stereographicDirection(const Vec2d& plane)
{
    const double q = 0.25*plane.dot(plane);
    return Vec3d(plane[0], plane[1], 1 - q)*(1/(1 + q));
}

}} // namespace

#endif // OPENCV_REFRACT_STEREOGRAPHIC_HPP
