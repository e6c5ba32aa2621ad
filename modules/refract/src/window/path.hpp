// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_PATH_HPP
#define OPENCV_REFRACT_PATH_HPP

#include "simd/lanes.hpp"
#include "window/layer_kernels.hpp"

/* The path of light from a point to the camera, for one point (T = double) and for many (T = Lanes).

In t = tan(theta) of the rarest medium, n_r sin(theta) = p:

    tan(theta_i) = n_r t / sqrt(n_i^2 + (n_i^2 - n_r^2) t^2)

The path reaches a point at the distance V from the window's axis where sum h_i tan(theta_i(t)) = V. The unknown is the ratio
t/V, regular on the axis:

    F(ratio) = sum h_i tan(theta_i) / V - 1 = 0

F is increasing and concave: Newton's method from a ratio left of the root rises monotonically to it. */

namespace cv { namespace refract { namespace {

//! From a point to the camera, as far as it does not depend on the ratio.
template<typename T>
struct Path
{
    T weight, scene;            //!< w of the point; height of the scene's medium
    T radial[3], radius2;       //!< of the point about the window's axis; V^2
};

template<typename T>
inline Path<T> pathTo(const Stack& s, T x, T y, T z, T weight)
{
    const T U = s.normal[0]*x + s.normal[1]*y + s.normal[2]*z;
    Path<T> path;
    path.weight = weight;
    path.scene = U - weight*s.total;
    path.radial[0] = x - U*s.normal[0];
    path.radial[1] = y - U*s.normal[1];
    path.radial[2] = z - U*s.normal[2];
    path.radius2 = square(path.radial[0]) + square(path.radial[1]) + square(path.radial[2]);
    return path;
}

template<typename T>
inline T heightOf(const Medium& medium, const Path<T>& path)
{
    const T height = path.weight*medium.height;
    return medium.isScene ? height + path.scene*medium.scale : height;
}

//! F with all media but the rarest at 0, and at their limits.
template<typename T>
struct PathBounds
{
    PathBounds(const Stack& s, const Path<T>& path) : rare(heightOf(s.media[0], path)), slope(rare), limit(T{})
    {
        for (int k = 1; k < s.count; k++)
        {
            const T h = heightOf(s.media[k], path);
            slope += h*s.media[k].slope;
            limit += h*s.media[k].limit;
        }
    }
    T rare, slope;      //!< height of the rarest medium; slope of F at 0
    T limit;            //!< of V by the other media, at grazing in the rarest
};

/* Where the search begins: left of the root, the larger of two bounds. F lies below its tangent at 0; and every denser
medium stays below its limit. The second wins far out only. */
template<typename T>
inline T firstRatio(const Stack& s, const Path<T>& path)
{
    const PathBounds<T> F(s, path);
    T ratio = roughInverse(F.slope);
    const auto far = path.radius2*square(F.slope - F.rare) > square(F.limit*F.slope);
    if (any(far))
    {
        const T radius = path.radius2*inverseSqrt(path.radius2);
        ratio = select(far & (F.rare > 0), larger(ratio, (radius - F.limit)/(F.rare*radius)), ratio);
    }
    return ratio;
}

//! F, its slope and -F''/2.
template<typename T>
struct PathFunction
{
    PathFunction(const Stack& s, const Path<T>& path, T ratio)
    {
        const T t2 = path.radius2*ratio*ratio;
        value = slope = heightOf(s.media[0], path);
        bend = T{};
        for (int k = 1; k < s.count; k++)
        {
            const Medium& medium = s.media[k];
            const double excess = medium.index2 - s.media[0].index2;
            const T root2 = medium.index2 + excess*t2, inverse = inverseSqrt(root2), inverse2 = inverse*inverse;
            const T term = heightOf(medium, path)*inverse, termSlope = term*medium.index2*inverse2;
            value += term;
            slope += termSlope;
            bend += termSlope*inverse2*excess;
        }
        value = ratio*value - 1;
        bend *= 1.5*ratio*path.radius2;
    }
    T value, slope, bend;
};

//! The direction in which the camera sees the point: normal + kappa radial, not unit.
template<typename T>
inline void direction(const Stack& s, const Path<T>& path, T ratio, T* d)
{
    const double inner2 = s.inner*s.inner, excess = inner2 - s.media[0].index2;
    T kappa = ratio;
    if (excess > 0)
        kappa *= s.rarest*inverseSqrt(inner2 + excess*path.radius2*ratio*ratio);
    for (int k = 0; k < 3; k++)
        d[k] = s.normal[k] + kappa*path.radial[k];
}

}}} // namespace

#endif // OPENCV_REFRACT_PATH_HPP
