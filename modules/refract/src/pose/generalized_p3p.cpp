// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/generalized_p3p.hpp"

namespace cv { namespace refract {

namespace {

//! The largest real root of x^3 + a x^2 + b x + c.
double largestCubicRoot(double a, double b, double c)
{
    const double shift = a/3, q = shift*shift - b/3, r = shift*shift*shift - shift*b/2 + c/2, root = std::sqrt(std::max(q, 0.));
    double x;
    if (q > 0 && r*r < q*q*q)
        x = 2*root*std::cos((std::acos(-r/(q*root)))/3) - shift;
    else
    {
        const double s = -std::copysign(std::cbrt(std::abs(r) + std::sqrt(std::max(r*r - q*q*q, 0.))), r);
        x = s + (s != 0 ? q/s : 0) - shift;
    }
    for (int k = 0; k < 2; k++)         // what the closed form lost
    {
        const double slope = (3*x + 2*a)*x + b;
        if (slope != 0)
            x -= (((x + a)*x + b)*x + c)/slope;
    }
    return x;
}

//! Both roots of x^2 + b x + c, or a double one in the middle where noise has parted them.
int quadraticRoots(double b, double c, double* roots)
{
    const double MISSED = 1e-3;         // of b^2/4
    const double discriminant = b*b/4 - c;
    if (!(discriminant > -MISSED*(b*b/4)))
        return 0;
    const double root = std::sqrt(std::max(discriminant, 0.));
    roots[0] = -b/2 + root;
    roots[1] = -b/2 - root;
    return discriminant > 0 ? 2 : 1;
}

//! Real roots of a4 x^4 + ... + a0 by Ferrari's method, to a few digits: Newton's method follows.
int quarticRoots(const double (&a)[5], double* roots)
{
    const double b = a[3]/a[4]/4, b2 = b*b;
    const double p = a[2]/a[4] - 6*b2, q = a[1]/a[4] - 2*b*a[2]/a[4] + 8*b2*b;
    const double r = a[0]/a[4] - b*a[1]/a[4] + b2*a[2]/a[4] - 3*b2*b2;
    const double m = largestCubicRoot(p, p*p/4 - r, -q*q/8), side = std::sqrt(std::max(2*m, 0.));
    const double skew = side > 0 ? q/(2*side) : 0;
    int count = quadraticRoots(side, p/2 + m - skew, roots);
    count += quadraticRoots(-side, p/2 + m + skew, roots + count);
    for (int i = 0; i < count; i++)
        roots[i] -= b;
    return count;
}

double squaredDistance(const Vec3d& a, const Vec3d& b) { return (a - b).dot(a - b); }

//! Grunert's solutions for rays from one point: how far along them the points are.
int centralDistances(const SceneRay (&rays)[3], const Vec3d (&object)[3], Vec3d* s)
{
    const double b2 = squaredDistance(object[0], object[2]);
    const double a = squaredDistance(object[1], object[2])/b2, c = squaredDistance(object[0], object[1])/b2;
    const double cosA = rays[1].direction.dot(rays[2].direction), cosB = rays[0].direction.dot(rays[2].direction);
    const double cosC = rays[0].direction.dot(rays[1].direction), less = a - c, sum = a + c;
    const double quartic[5] = {
        (1 + less)*(1 + less) - 4*a*cosC*cosC,
        4*(-less*(1 + less)*cosB + 2*a*cosC*cosC*cosB - (1 - sum)*cosA*cosC),
        2*(less*less - 1 + 2*less*less*cosB*cosB + 2*(1 - c)*cosA*cosA - 4*sum*cosA*cosB*cosC + 2*(1 - a)*cosC*cosC),
        4*(less*(1 - less)*cosB - (1 - sum)*cosA*cosC + 2*c*cosA*cosA*cosB),
        (less - 1)*(less - 1) - 4*c*cosA*cosA };
    double roots[4];
    const int count = quarticRoots(quartic, roots);
    int found = 0;
    for (int i = 0; i < count; i++)
    {
        const double v = roots[i], u = ((less - 1)*v*v - 2*less*cosB*v + 1 + less)/(2*(cosC - v*cosA));
        const double first = std::sqrt(b2/(1 + v*v - 2*v*cosB));
        if (v > 0 && u > 0 && std::isfinite(u*first))
            s[found++] = Vec3d(first, u*first, v*first);
    }
    return found;
}

//! Orthonormal axes of a triangle, as columns.
Matx33d axesOf(const Vec3d (&X)[3])
{
    const Vec3d x = normalize(X[1] - X[0]), z = normalize(x.cross(X[2] - X[0])), y = z.cross(x);
    return Matx33d(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]);
}

} // namespace

bool solveDistances(const SceneRay (&rays)[3], const Vec3d& squaredSides, Vec3d& s, Vec3d (&X)[3])
{
    const double ENOUGH = 1e-9;         // the next step squares it
    for (int k = 0; k < 10; k++)
    {
        for (int i = 0; i < 3; i++)
            X[i] = rays[i].origin + s[i]*rays[i].direction;
        Vec3d f;
        Matx33d J = Matx33d::zeros();
        for (int i = 0; i < 3; i++)
        {
            const int j = (i + 1) % 3;
            const Vec3d between = X[i] - X[j];
            f[i] = (between.dot(between) - squaredSides[i])/2;
            J(i, i) = between.dot(rays[i].direction);
            J(i, j) = -between.dot(rays[j].direction);
        }
        // J = [a b 0; 0 c d; e 0 f]
        const double det = J(0, 0)*J(1, 1)*J(2, 2) + J(0, 1)*J(1, 2)*J(2, 0);
        const Vec3d step = Vec3d(J(1, 1)*J(2, 2)*f[0] - J(0, 1)*J(2, 2)*f[1] + J(0, 1)*J(1, 2)*f[2],
                                 J(1, 2)*J(2, 0)*f[0] + J(0, 0)*J(2, 2)*f[1] - J(0, 0)*J(1, 2)*f[2],
                                 -J(1, 1)*J(2, 0)*f[0] + J(0, 1)*J(2, 0)*f[1] + J(0, 0)*J(1, 1)*f[2])/det;
        s -= step;
        if (!(s[0] > 0 && s[1] > 0 && s[2] > 0))
            return false;
        if (step.dot(step) < ENOUGH*ENOUGH*s.dot(s))
        {
            for (int i = 0; i < 3; i++)
                X[i] = rays[i].origin + s[i]*rays[i].direction;
            return true;
        }
    }
    return false;
}

bool isTriangle(const Vec3d (&object)[3])
{
    const double FLAT = 1e-6;           // sine of an angle of the triangle
    const Vec3d side = object[1] - object[0], other = object[2] - object[0];
    return norm(side.cross(other)) > FLAT*std::max(side.dot(side), other.dot(other));
}

Vec3d squaredSides(const Vec3d (&object)[3])
{
    return Vec3d(squaredDistance(object[0], object[1]), squaredDistance(object[1], object[2]),
                 squaredDistance(object[2], object[0]));
}

RigidTransform motionOfTriangle(const Vec3d (&object)[3], const Vec3d (&X)[3])
{
    const Matx33d R = axesOf(X)*axesOf(object).t();
    return { R, X[0] - R*object[0] };
}

int posesOfThreeRays(const SceneRay (&rays)[3], const Vec3d (&object)[3], RigidTransform (&motions)[4])
{
    if (!isTriangle(object))
        return 0;
    const Vec3d D2 = squaredSides(object);
    Vec3d starts[4], X[3];
    const int count = centralDistances(rays, object, starts);
    // The starts are distances from the mean origin.
    const Vec3d mean = (rays[0].origin + rays[1].origin + rays[2].origin)*(1./3);
    int found = 0;
    for (int k = 0; k < count; k++)
    {
        for (int i = 0; i < 3; i++)
            starts[k][i] -= (rays[i].origin - mean).dot(rays[i].direction);
        if (solveDistances(rays, D2, starts[k], X))
            motions[found++] = motionOfTriangle(object, X);
    }
    return found;
}

PointRays::PointRays(const Camera& camera, const ImagePoints& points)
{
    for (size_t i = 0; i < points.pixel.size(); i++)
    {
        SceneRay seen;
        if (!isWhole(points.pixel[i]) || camera.unproject(points.pixel[i], seen.origin, seen.direction) != REFRACT_OK)
            continue;
        ray.push_back(seen);
        point.push_back((int)i);
    }
}

}} // namespace
