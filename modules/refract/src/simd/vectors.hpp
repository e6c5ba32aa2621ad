// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_VECTORS_HPP
#define OPENCV_REFRACT_VECTORS_HPP

#include "simd/columns.hpp"
#include "simd/lanes.hpp"

/* Vectors and matrices of all lanes at once. */

namespace cv { namespace refract { namespace {

template<typename At>
inline void storeAt(Lanes a, const Columns& columns, int row, int column, At at)
{
    store(a, columns.at(row, column), at);
}

struct Vector { Lanes x, y, z; };

template<typename At>
inline Vector loadRow(const Columns& columns, int row, At at)
{
    return { load(columns.at(row, 0), at), load(columns.at(row, 1), at), load(columns.at(row, 2), at) };
}
inline Lanes dot(const Vector& a, const Vector& b) { return a.x*b.x + a.y*b.y + a.z*b.z; }
inline Lanes dot(const double* a, const Vector& b) { return a[0]*b.x + a[1]*b.y + a[2]*b.z; }

inline Vector cross(const Vector& a, const Vector& b)
{
    return { a.y*b.z - a.z*b.y, a.z*b.x - a.x*b.z, a.x*b.y - a.y*b.x };
}

//! Into the frame whose axes are the rows, and back.
inline Vector intoFrame(const double* axes, const Vector& a) { return { dot(axes, a), dot(axes + 3, a), dot(axes + 6, a) }; }
inline Vector outOfFrame(const double* axes, const Vector& a)
{
    return { axes[0]*a.x + axes[3]*a.y + axes[6]*a.z, axes[1]*a.x + axes[4]*a.y + axes[7]*a.z,
             axes[2]*a.x + axes[5]*a.y + axes[8]*a.z };
}

//! Two unit vectors across d and each other (@cite Duff2017).
inline void vectorsAcross(const Vector& d, Vector& a, Vector& b)
{
    const Lanes sign = select(d.z < 0, all(-1), all(1)), k = -1/(sign + d.z), xy = d.x*d.y*k;
    a = { 1 + sign*d.x*d.x*k, sign*xy, -sign*d.x };
    b = { xy, sign + d.y*d.y*k, -d.y };
}

}}} // namespace

#endif // OPENCV_REFRACT_VECTORS_HPP
