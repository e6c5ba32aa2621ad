// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The model once more, one point at a time and as the textbook has it: in long double the reference that errors are
// measured against, in double the straightforward scalar program that speed is measured against. It shares nothing with
// the module.
#ifndef REFRACT_BENCH_REFERENCE_HPP
#define REFRACT_BENCH_REFERENCE_HPP

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace reference {

template<typename T> using Vec2 = std::array<T, 2>;
template<typename T> using Vec3 = std::array<T, 3>;

template<typename T>
T dot(const Vec3<T>& a, const Vec3<T>& b) { return a[0]*b[0] + a[1]*b[1] + a[2]*b[2]; }

//! a + s b
template<typename T>
Vec3<T> add(const Vec3<T>& a, T s, const Vec3<T>& b) { return { a[0] + s*b[0], a[1] + s*b[1], a[2] + s*b[2] }; }

//! Unit direction behind a face of unit normal m. @param ratio index before it over that behind it
template<typename T>
Vec3<T> refracted(const Vec3<T>& d, T ratio, const Vec3<T>& m)
{
    const T c = dot(m, d);
    return add({ ratio*d[0], ratio*d[1], ratio*d[2] }, std::sqrt(1 - ratio*ratio*(1 - c*c)) - ratio*c, m);
}

template<typename T>
struct Lens
{
    T fx, fy, cx, cy;
    std::array<T, 14> k;        //!< OpenCV's order; fisheye: the first four
    bool fisheye;
    std::array<T, 9> tilt;      //!< homography of the tilted sensor

    Vec2<T> distort(T x, T y) const
    {
        const T s = x*x + y*y;
        const T F = (1 + s*(k[0] + s*(k[1] + s*k[4])))/(1 + s*(k[5] + s*(k[6] + s*k[7])));
        const T a = x*F + 2*k[2]*x*y + k[3]*(s + 2*x*x) + s*(k[8] + s*k[9]);
        const T b = y*F + k[2]*(s + 2*y*y) + 2*k[3]*x*y + s*(k[10] + s*k[11]);
        const T w = tilt[6]*a + tilt[7]*b + tilt[8];
        return { (tilt[0]*a + tilt[1]*b + tilt[2])/w, (tilt[3]*a + tilt[4]*b + tilt[5])/w };
    }
    T bend(T theta) const
    {
        const T s = theta*theta;
        return theta*(1 + s*(k[0] + s*(k[1] + s*(k[2] + s*k[3]))));
    }
    Vec2<T> project(const Vec3<T>& d) const
    {
        Vec2<T> p;
        if (fisheye)
        {
            const T r = std::sqrt(d[0]*d[0] + d[1]*d[1]), scale = r > 0 ? bend(std::atan2(r, d[2]))/r : 1/d[2];
            p = { d[0]*scale, d[1]*scale };
        }
        else
            p = distort(d[0]/d[2], d[1]/d[2]);
        return { fx*p[0] + cx, fy*p[1] + cy };
    }
    //! Unit direction, by Newton's method with differences for slopes.
    Vec3<T> unproject(const Vec2<T>& pixel) const
    {
        const T xd = (pixel[0] - cx)/fx, yd = (pixel[1] - cy)/fy, h = sizeof(T) > 8 ? 1e-9L : 1e-7;
        if (fisheye)
        {
            const T target = std::sqrt(xd*xd + yd*yd);
            T theta = target;
            for (int i = 0; i < 12; i++)
                theta -= (bend(theta) - target)*2*h/(bend(theta + h) - bend(theta - h));
            const T scale = target > 0 ? std::sin(theta)/target : 1;
            return { xd*scale, yd*scale, std::cos(theta) };
        }
        T x = xd, y = yd;
        for (int i = 0; i < 12; i++)
        {
            const Vec2<T> p = distort(x, y), a = distort(x + h, y), b = distort(x - h, y), c = distort(x, y + h),
                          d = distort(x, y - h);
            const T xx = (a[0] - b[0])/(2*h), yx = (a[1] - b[1])/(2*h), xy = (c[0] - d[0])/(2*h),
                    yy = (c[1] - d[1])/(2*h), det = xx*yy - xy*yx, ex = p[0] - xd, ey = p[1] - yd;
            const T dx = (yy*ex - xy*ey)/det, dy = (xx*ey - yx*ex)/det;
            x -= dx;
            y -= dy;
            if (std::abs(dx) + std::abs(dy) <= 4*std::numeric_limits<T>::epsilon())
                break;
        }
        const T length = std::sqrt(1 + x*x + y*y);
        return { x/length, y/length, 1/length };
    }
};

template<typename T>
struct Ray { Vec3<T> origin, direction; };

//! How far two rays are apart where they meet the plane of a depth, over that depth: pixels of a pinhole with focal length 1.
template<typename T>
T apart(const Ray<T>& one, const Ray<T>& other, T depth)
{
    const Vec3<T> X = add(one.origin, (depth - one.origin[2])/one.direction[2], one.direction);
    const Vec3<T> Y = add(other.origin, (depth - other.origin[2])/other.direction[2], other.direction);
    return std::hypot(X[0] - Y[0], X[1] - Y[1])/depth;
}

//! Lens and window.
template<typename T>
struct Camera
{
    Lens<T> lens;
    Vec3<T> normal;
    std::vector<T> height, index;       //!< gap and layers; media from the camera's to the scene's, one more

    //! Vector Snell, surface by surface, then back to the axis.
    Ray<T> unproject(const Vec2<T>& pixel) const
    {
        Vec3<T> d = lens.unproject(pixel), point = { 0, 0, 0 };
        for (size_t k = 0; k < height.size(); k++)
        {
            point = add(point, height[k]/dot(normal, d), d);
            d = refracted(d, index[k]/index[k + 1], normal);
        }
        const T c = dot(normal, d);
        const Vec3<T> radial = add(point, -dot(normal, point), normal), slope = add(d, -c, normal);
        const T s2 = dot(slope, slope), back = s2 > 0 ? dot(radial, slope)/s2 : 0;
        const T tau = dot(normal, point) - back*c;
        return { { tau*normal[0], tau*normal[1], tau*normal[2] }, d };
    }

    //! Newton on the tangent in the rarest medium, from below the root of a concave function: it cannot overshoot.
    Vec2<T> project(const Vec3<T>& X) const
    {
        T total = 0, rarest = index[0];
        for (T h : height)
            total += h;
        for (T n : index)
            rarest = std::min(rarest, n);
        const T U = dot(normal, X), outside = U - total;
        const Vec3<T> radial = add(X, -U, normal);
        const T V = std::sqrt(dot(radial, radial));
        T t = V/U;
        for (int i = 0; i < 60; i++)
        {
            T f = -V, slope = 0;
            for (size_t k = 0; k < index.size(); k++)
            {
                const T h = k < height.size() ? height[k] : outside, n = index[k];
                const T root2 = n*n + (n*n - rarest*rarest)*t*t, root = std::sqrt(root2);
                f += h*rarest*t/root;
                slope += h*rarest*n*n/(root*root2);
            }
            const T step = -f/slope;
            t += step;
            if (!(std::abs(step) > 2*std::numeric_limits<T>::epsilon()*t))
                break;
        }
        const T inner = rarest*t/std::sqrt(index[0]*index[0] + (index[0]*index[0] - rarest*rarest)*t*t);
        return lens.project(V > 0 ? add(normal, inner/V, radial) : normal);
    }
};

} // namespace reference

#endif // REFRACT_BENCH_REFERENCE_HPP
