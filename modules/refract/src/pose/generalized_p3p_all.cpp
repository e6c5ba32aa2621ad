// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* All solutions of the generalised perspective three-point problem. With the first point x along its ray, each of the other two is
at one of two places on its own, those at the right distance from the first. What is left is the distance between these two:

    g(x) = |X_1(x) - X_2(x)|^2 - D_12^2

on four branches. Their product has no square root: a polynomial of degree 8 in x (Nister and Stewenius, A minimal solution to the
generalised 3-point pose problem, 2007), which is interpolated where all branches are real. */

#include "pose/generalized_p3p.hpp"
#include "math/monotone.hpp"

namespace cv { namespace refract {

namespace {

const int DEGREE = 8;

double valueOf(const std::vector<double>& coefficients, double x)
{
    double value = 0;
    for (size_t k = coefficients.size(); k-- > 0;)
        value = value*x + coefficients[k];
    return value;
}

std::vector<double> derivativeOf(const std::vector<double>& coefficients)
{
    std::vector<double> slope;
    for (size_t k = 1; k < coefficients.size(); k++)
        slope.push_back((double)k*coefficients[k]);
    return slope;
}

//! Where a polynomial changes its sign, to nine digits: between two neighbours of its derivative's roots it does so once at most.
std::vector<double> rootsBetween(const std::vector<double>& coefficients, double low, double high)
{
    const int HALVINGS = 30;
    std::vector<double> roots, ends;
    if (coefficients.size() < 2)
        return roots;
    ends = rootsBetween(derivativeOf(coefficients), low, high);
    ends.insert(ends.begin(), low);
    ends.push_back(high);
    for (size_t i = 1; i < ends.size(); i++)
    {
        double a = ends[i - 1], b = ends[i];
        const bool isPositive = valueOf(coefficients, a) > 0;
        if (isPositive == (valueOf(coefficients, b) > 0))
            continue;
        for (int k = 0; k < HALVINGS; k++)
        {
            const double middle = (a + b)/2;
            ((valueOf(coefficients, middle) > 0) == isPositive ? a : b) = middle;
        }
        roots.push_back((a + b)/2);
    }
    return roots;
}

//! Where along a ray a point is, of which the distance from X is known: two places.
Vec2d placesAlong(const SceneRay& ray, const Vec3d& X, double squaredDistance)
{
    const Vec3d w = ray.origin - X;
    const double middle = -ray.direction.dot(w);
    const double half = std::sqrt(std::max(middle*middle - w.dot(w) + squaredDistance, 0.));
    return Vec2d(middle - half, middle + half);
}

//! Makes an interval of distances along a ray smaller: those from where another ray is not too far.
void intersectReach(const SceneRay& ray, const SceneRay& other, double squaredDistance, Vec2d& interval)
{
    const Matx33d across = Matx33d::eye() - other.direction*other.direction.t();
    const Vec3d a = across*(other.origin - ray.origin), b = across*ray.direction;
    const double middle = a.dot(b)/b.dot(b);
    const double half = std::sqrt(middle*middle - (a.dot(a) - squaredDistance)/b.dot(b));      // NaN: too far everywhere
    interval = half >= 0 ? Vec2d(std::max(interval[0], middle - half), std::min(interval[1], middle + half)) : Vec2d(1, 0);
}

} // namespace

std::vector<RigidTransform> allPosesOfThreeRays(const SceneRay (&rays)[3], const Vec3d (&object)[3])
{
    const double SAME = 1e-7;           // of the distances
    std::vector<RigidTransform> motions;
    const Vec3d D2 = squaredSides(object);
    Vec2d reach(0, DBL_MAX);
    intersectReach(rays[0], rays[1], D2[0], reach);
    intersectReach(rays[0], rays[2], D2[2], reach);
    if (!isTriangle(object) || !(reach[0] < reach[1]) || !(reach[1] < DBL_MAX))
        return motions;
    const auto distanceAt = [&](double node) { return (reach[0] + reach[1] + node*(reach[1] - reach[0]))/2; };
    const auto branchesAt = [&](double x, Vec2d& y, Vec2d& z)
    {
        const Vec3d X = rays[0].origin + x*rays[0].direction;
        y = placesAlong(rays[1], X, D2[0]);
        z = placesAlong(rays[2], X, D2[2]);
    };

    double nodes[DEGREE + 1];
    std::vector<double> product(DEGREE + 1, 1.);
    for (int k = 0; k <= DEGREE; k++)
    {
        Vec2d y, z;
        nodes[k] = std::cos(CV_PI*k/DEGREE);
        branchesAt(distanceAt(nodes[k]), y, z);
        for (int branch = 0; branch < 4; branch++)
        {
            const Vec3d between = rays[1].origin + y[branch/2]*rays[1].direction
                                  - rays[2].origin - z[branch%2]*rays[2].direction;
            product[k] *= between.dot(between)/D2[1] - 1;
        }
    }
    fitPolynomial(DEGREE + 1, nodes, product.data());

    // Two roots that rounding has merged or parted are at a root of the derivative. Newton's method finds them from both sides:
    // between them its matrix is singular.
    std::vector<double> starts = rootsBetween(product, -1, 1);
    for (double extremum : rootsBetween(derivativeOf(product), -1, 1))
        for (double aside : { 0., 1e-7, -1e-7, 1e-6, -1e-6, 1e-5, -1e-5 })     // rounding moves two roots that are one by 1e-6
            starts.push_back(extremum + aside);
    std::vector<Vec3d> found;
    for (double start : starts)
        for (int branch = 0; branch < 4; branch++)
        {
            Vec2d y, z;
            Vec3d X[3];
            branchesAt(distanceAt(start), y, z);
            Vec3d s(distanceAt(start), y[branch/2], z[branch%2]);
            if (!solveDistances(rays, D2, s, X) || std::any_of(found.begin(), found.end(), [&](const Vec3d& other)
                                                              { return norm(other - s) < SAME*norm(s); }))
                continue;
            found.push_back(s);
            motions.push_back(motionOfTriangle(object, X));
        }
    return motions;
}

}} // namespace
