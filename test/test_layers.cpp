// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The physics of parallel layers, through the inner header.
#include "window/layers.hpp"
#include "quick_require.hpp"
#include "scenes.hpp"

#include <memory>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

struct Ray { double tau; Vec3d direction; uchar status; };

Ray traceOut(const Layers& layers, const Vec3d& w, uchar status = REFRACT_OK)
{
    Rays rays;
    layers.traceOut(1, &w[0], &w[1], &w[2], rays, &status);
    return { rays.tau[0], rays.direction(0), status };
}

uchar solveIn(const Layers& layers, const Vec3d& X, double w, Vec3d& direction, uchar status = REFRACT_OK)
{
    layers.solveIn(1, &X[0], &X[1], &X[2], &w, &direction[0], &direction[1], &direction[2], &status);
    return status;
}

//! Derivatives of the direction, row-major: by the point (3x3), by the window (3 x at().count).
uchar solveInJacobian(const Layers& layers, const Vec3d& X, Vec3d& direction, double* dX, double* dWindow)
{
    uchar status = REFRACT_OK;
    double ratio = 0;
    layers.solveIn(1, &X[0], &X[1], &X[2], nullptr, &direction[0], &direction[1], &direction[2], &status, &ratio);
    Matx33d identity = Matx33d::eye();
    layers.chain(3, 1, &X[0], &X[1], &X[2], &direction[0], &direction[1], &direction[2], &ratio, { identity.val, 3, 1 }, { dX, 3, 1 },
                 { dWindow, layers.at().count, 1 });
    return status;
}

Vec3d unit(const Vec3d& v) { return v/norm(v); }

//! Inner direction at an angle from the window's normal, random azimuth.
Vec3d directionAt(const Vec3d& n, double angle, Random& random)
{
    const Vec3d across = unit(n.cross(Vec3d(0.36, 0.48, -0.8))), third = n.cross(across);
    const double azimuth = random.uniform(0, 2*CV_PI);
    return std::cos(angle)*n + std::sin(angle)*(std::cos(azimuth)*across + std::sin(azimuth)*third);
}

//! Vector Snell surface by surface: a point on the outgoing line, its direction. False: total reflection.
bool traceSurfaces(const GlassWindow& window, Vec3d direction, Vec3d& point, Vec3d& out)
{
    point = Vec3d();
    double medium = window.innerIndex, height = window.distance;
    for (size_t k = 0; k <= window.thickness.size(); k++)
    {
        const double next = k < window.index.size() ? window.index[k] : window.outerIndex;
        const double c = window.normal.dot(direction), ratio = medium/next, square = 1 - ratio*ratio*(1 - c*c);
        point += height/c*direction;
        if (square <= 0)
            return false;
        direction = ratio*direction + (std::sqrt(square) - ratio*c)*window.normal;
        medium = next;
        height = k < window.thickness.size() ? window.thickness[k] : 0;
    }
    out = unit(direction);
    return true;
}

double smallestIndex(const GlassWindow& w)
{
    double least = std::min(w.innerIndex, w.outerIndex);
    for (double n : w.index)
        least = std::min(least, n);
    return least;
}

} // namespace

TEST_CASE("One pane in air: the paper's equations (12) and (16)", "[layers]")
{
    const double thickness = 20, mu = 1.5437;
    const Layers layers(GlassWindow(Vec3d(0, 0, 1), thickness, mu, 123));
    for (double degrees : { 0., 1e-6, 1., 30., 60., 89., 89.9, 89.999 })
    {
        CAPTURE(degrees);
        const double s = std::sin(degrees*CV_PI/180), c = std::cos(degrees*CV_PI/180);
        const Ray ray = traceOut(layers, Vec3d(0.6*s, -0.8*s, c));
        CHECK(ray.status == REFRACT_OK);
        CHECK(ray.tau == Approx(thickness*(1 - c/std::sqrt(mu*mu - s*s))).epsilon(1e-13));
        CHECK(norm(ray.direction - Vec3d(0.6*s, -0.8*s, c)) < 4e-16);
    }
}

TEST_CASE("A pane in air shifts rays the same at any distance", "[layers]")
{
    CAPTURE(seed());
    Random random(1);
    const Vec3d n = randomNormal(random, 30), w = directionAt(n, 1.1, random);
    const Ray close = traceOut(Layers(GlassWindow(n, 15, 1.5, 0)), w);
    const Ray far = traceOut(Layers(GlassWindow(n, 15, 1.5, 1e6)), w);
    CHECK(close.tau == far.tau);
    CHECK(close.direction == far.direction);
}

TEST_CASE("traceOut agrees with Snell's law surface by surface", "[layers]")
{
    const WindowKind kind = GENERATE(from_range(parallelWindows()));
    CAPTURE(name(kind), seed());
    Random random(kind);
    int seen = 0, reflected = 0;
    for (int i = 0; i < 3000; i++)
    {
        const GlassWindow window = makeWindow(kind, random);
        const Vec3d w = directionAt(window.normal, random.uniform(0, 88)*CV_PI/180, random);
        const Ray ray = traceOut(Layers(window), w);
        Vec3d point, direction;
        if (!traceSurfaces(window, w, point, direction))
        {
            reflected++;
            REQUIRE(ray.status == REFRACT_TOTAL_REFLECTION);
            continue;
        }
        // Next to the critical angle both computations lose digits with the cosine in the rarest medium.
        const double sine = norm(window.normal.cross(w))*window.innerIndex/smallestIndex(window);
        if (sine > 0.9999)
            continue;
        const double cosine = std::sqrt(1 - sine*sine);
        seen++;
        REQUIRE(ray.status == REFRACT_OK);
        REQUIRE(norm(ray.direction - direction) < 1e-14/cosine);
        REQUIRE(std::abs(norm(ray.direction) - 1) < 1e-14/cosine);
        const Vec3d offset = point - ray.tau*window.normal;
        REQUIRE(norm(offset.cross(direction)) < 1e-13/cosine*(1 + norm(point)));
    }
    CHECK(seen > 1000);
    const bool canReflect = kind == WATER_GLASS_AIR || kind == DOUBLE_GLAZING_IN_WATER;
    CHECK((reflected > 100) == canReflect);
}

TEST_CASE("solveIn returns the direction that traceOut came from", "[layers]")
{
    const WindowKind kind = GENERATE(from_range(parallelWindows()));
    CAPTURE(name(kind), seed());
    Random random(kind);
    for (int i = 0; i < 5000; i++)
    {
        const GlassWindow window = makeWindow(kind, random, 60);
        const double largest = std::min(1., smallestIndex(window)/window.innerIndex);
        const Vec3d w = directionAt(window.normal, std::asin(largest*std::sin(random.uniform(0, 89.9)*CV_PI/180)), random);
        const Layers layers(window);
        const Ray ray = traceOut(layers, w);
        QUICK_REQUIRE(ray.status == REFRACT_OK, i, w);
        double total = window.distance;
        for (double t : window.thickness)
            total += t;
        const double c = window.normal.dot(ray.direction);
        const double s = (total - ray.tau)/c + random.logUniform(1e-2, 1e5)/c;
        const Vec3d X = ray.tau*window.normal + s*ray.direction;
        QUICK_REQUIRE(layers.isBeyond(X[0], X[1], X[2]), i, w);
        Vec3d back;
        QUICK_REQUIRE(solveIn(layers, X, 1, back) == REFRACT_OK, i, w);
        // At 89.9 degrees in the rarer medium a rounding of X is 1/cos times larger in the other.
        QUICK_REQUIRE(norm(unit(back) - w) < 2e-15/std::cos(89.9*CV_PI/180), i, w);
    }
}

TEST_CASE("Infinitely far points keep or refract their direction by Snell's law alone", "[layers]")
{
    const WindowKind kind = GENERATE(from_range(parallelWindows()));
    CAPTURE(name(kind), seed());
    Random random(kind);
    for (int i = 0; i < 300; i++)
    {
        const GlassWindow window = makeWindow(kind, random);
        const double largest = std::min(1., smallestIndex(window)/window.outerIndex);
        const Vec3d d = directionAt(window.normal, std::asin(largest*std::sin(random.uniform(0, 85)*CV_PI/180)), random);
        Vec3d w;
        REQUIRE(solveIn(Layers(window), random.logUniform(1e-3, 1e3)*d, 0, w) == REFRACT_OK);
        const Vec3d across = window.innerIndex*window.normal.cross(unit(w)) - window.outerIndex*window.normal.cross(d);
        REQUIRE(norm(across) < 1e-13);
    }
}

TEST_CASE("A copy of layers does without the original", "[layers]")
{
    Random random;
    std::unique_ptr<Layers> original(new Layers(makeWindow(PANE_IN_AIR, random)));
    const Vec3d w = unit(Vec3d(0.1, -0.2, 1));
    const Ray expected = traceOut(*original, w);
    const Layers copy(*original);
    Layers assigned(GlassWindow(Vec3d(0, 0, 1), 5, 1.4, 3));
    assigned = *original;
    original.reset();
    for (const Layers* layers : { &copy, (const Layers*)&assigned })
    {
        const Ray ray = traceOut(*layers, w);
        CHECK(ray.tau == expected.tau);
        CHECK(ray.direction == expected.direction);
    }
    CHECK(copy.stack().media != assigned.stack().media);
    CHECK(copy.stack().heights != assigned.stack().heights);
    CHECK(copy.stack().indices != assigned.stack().indices);
}

TEST_CASE("Homogeneous points: only the ratio to w counts", "[layers]")
{
    CAPTURE(seed());
    Random random(3);
    const Layers layers(makeWindow(AIR_GLASS_WATER, random));
    const Vec3d X(80, -30, 900);
    Vec3d a, b;
    REQUIRE(solveIn(layers, X, 1, a) == REFRACT_OK);
    REQUIRE(solveIn(layers, X*1e-4, 1e-4, b) == REFRACT_OK);
    CHECK(norm(unit(a) - unit(b)) < 1e-15);
}

TEST_CASE("Windows from very thin to very thick, very faint to very dense", "[layers]")
{
    CAPTURE(seed());
    Random random(4);
    for (double thickness : { 1e-3, 1., 1e3 })
        for (double index : { 1.0001, 1.5, 4. })
            for (double outer : { 1., 1.333, 4. })
                for (double degrees : { 0., 1e-7, 45., 85., 89.9 })
                {
                    const Vec3d n = randomNormal(random, 40);
                    const Layers layers(GlassWindow(n, thickness, index, 3, outer));
                    const Vec3d w = directionAt(n, degrees*CV_PI/180, random);
                    CAPTURE(thickness, index, outer, degrees);
                    const Ray ray = traceOut(layers, w);
                    REQUIRE(ray.status == REFRACT_OK);
                    const double beyond = (3 + thickness - ray.tau + 50)/n.dot(ray.direction);
                    Vec3d back;
                    REQUIRE(solveIn(layers, ray.tau*n + beyond*ray.direction, 1, back) == REFRACT_OK);
                    CHECK(norm(unit(back) - w) < 1e-12);
                }
}

TEST_CASE("Every way of having no answer has its status", "[layers]")
{
    Vec3d direction;
    const Layers pane(GlassWindow(Vec3d(0, 0, 1), 20, 1.5, 50));
    CHECK(solveIn(pane, Vec3d(1, 2, 70.001), 1, direction) == REFRACT_OK);
    for (double z : { 70., 69.9, 60., 50., 10., 0., -5. })      // on the last surface, inside, before, behind
    {
        CAPTURE(z);
        CHECK(solveIn(pane, Vec3d(1, 2, z), 1, direction) == REFRACT_BEHIND_WINDOW);
        CHECK_FALSE(pane.isBeyond(1, 2, z));
    }
    CHECK(solveIn(pane, Vec3d(1, 2, 0), 0, direction) == REFRACT_BEHIND_WINDOW);    // at infinity, parallel to it
    CHECK(traceOut(pane, Vec3d(1, 0, 0)).status == REFRACT_BEHIND_WINDOW);
    CHECK(traceOut(pane, Vec3d(0, 0.6, -0.8)).status == REFRACT_BEHIND_WINDOW);

    // Glass on the lens, water outside: nothing arrives from beyond the cone of total reflection.
    const Layers onLens(GlassWindow(Vec3d(0, 0, 1), 8, 1.52, 0, 1.333));
    const double limit = 8/std::sqrt(1.52*1.52 - 1) + 100/std::sqrt(1.333*1.333 - 1);
    CHECK(solveIn(onLens, Vec3d(limit*(1 - 1e-9), 0, 108), 1, direction) == REFRACT_OK);
    CHECK(solveIn(onLens, Vec3d(limit*(1 + 1e-9), 0, 108), 1, direction) == REFRACT_TOTAL_REFLECTION);
    CHECK(solveIn(onLens, Vec3d(1e9, 0, 108), 1, direction) == REFRACT_TOTAL_REFLECTION);
    CHECK(solveIn(onLens, Vec3d(1, 0, 0.5), 0, direction) == REFRACT_TOTAL_REFLECTION);

    GlassWindow tank(Vec3d(0, 0, 1), 12, 1.5, 60);
    tank.innerIndex = 1.333;
    const double critical = std::asin(1/1.333);
    CHECK(traceOut(Layers(tank), Vec3d(std::sin(critical - 1e-9), 0, std::cos(critical - 1e-9))).status == REFRACT_OK);
    CHECK(traceOut(Layers(tank), Vec3d(std::sin(critical + 1e-9), 0, std::cos(critical + 1e-9))).status
          == REFRACT_TOTAL_REFLECTION);
    // From the air every point has an image, however far to the side.
    CHECK(solveIn(Layers(tank), Vec3d(1e9, 0, 72.001), 1, direction) == REFRACT_OK);
}

TEST_CASE("A lane that has a status keeps it", "[layers]")
{
    const Layers layers(GlassWindow(Vec3d(0, 0, 1), 20, 1.5, 50));
    Vec3d direction;
    for (uchar status : { REFRACT_NOT_FINITE, REFRACT_OUTSIDE_LENS_MODEL })
    {
        CHECK(solveIn(layers, Vec3d(1, 2, 900), 1, direction, status) == status);
        CHECK(solveIn(layers, Vec3d(1, 2, -9), 1, direction, status) == status);
        CHECK(solveIn(layers, Vec3d(NaN, 2, 900), 1, direction, status) == status);
        CHECK(traceOut(layers, Vec3d(0, 0, 1), status).status == status);
        CHECK(traceOut(layers, Vec3d(0, 0, -1), status).status == status);
    }
}

TEST_CASE("No window passes everything unchanged", "[layers]")
{
    const Layers none;
    CHECK_FALSE(none.refracts());
    const Vec3d w = unit(Vec3d(0.3, -0.4, 0.5));
    const Ray ray = traceOut(none, w);
    CHECK(ray.tau == 0);
    CHECK(ray.direction == w);
    Vec3d direction;
    CHECK(solveIn(none, Vec3d(3, 4, -5), 1, direction) == REFRACT_OK);
    CHECK(direction == Vec3d(3, 4, -5));
    // A surface between equal media is none either; between unequal media it is one.
    GlassWindow surface;
    surface.innerIndex = surface.outerIndex = 1.333;
    CHECK_FALSE(Layers(surface).refracts());
    surface.innerIndex = 1;
    CHECK(Layers(surface).refracts());
}

// ---- derivatives

namespace {

//! Parameters in the order of the jacobian's columns; the normal unnormalised.
std::vector<double> parametersOf(const GlassWindow& w)
{
    std::vector<double> p = { w.normal[0], w.normal[1], w.normal[2], w.distance };
    p.insert(p.end(), w.thickness.begin(), w.thickness.end());
    p.insert(p.end(), w.index.begin(), w.index.end());
    p.push_back(w.innerIndex);
    p.push_back(w.outerIndex);
    return p;
}

GlassWindow windowOf(const std::vector<double>& p)
{
    GlassWindow w;
    const size_t layers = (p.size() - 6)/2;
    w.normal = unit(Vec3d(p[0], p[1], p[2]));
    w.distance = p[3];
    w.thickness.assign(p.begin() + 4, p.begin() + 4 + layers);
    w.index.assign(p.begin() + 4 + layers, p.begin() + 4 + 2*layers);
    w.innerIndex = p[p.size() - 2];
    w.outerIndex = p.back();
    return w;
}

//! The direction, unit: what its length does is not promised.
Vec3d unitDirection(const std::vector<double>& window, const Vec3d& X)
{
    Vec3d d;
    REQUIRE(solveIn(Layers(windowOf(window)), X, 1, d) == REFRACT_OK);
    return unit(d);
}

//! Derivative of v/|v| from v and its derivative.
Vec3d unitDerivative(const Vec3d& v, const Vec3d& dv)
{
    const Vec3d u = unit(v);
    return (dv - u.dot(dv)*u)/norm(v);
}

} // namespace

TEST_CASE("Derivatives of solveIn against central differences of several steps", "[layers]")
{
    const WindowKind kind = GENERATE(PANE_IN_AIR, LAMINATE, AIR_GLASS_WATER, BARE_WATER, WATER_GLASS_AIR,
                                     DOUBLE_GLAZING_IN_WATER);
    CAPTURE(name(kind), seed());
    Random random(kind);
    for (int i = 0; i < 40; i++)
    {
        // All media a little denser: the same light paths, and room for the differences above index 1.
        GlassWindow window = makeWindow(kind, random);
        window.innerIndex *= 1.01;
        window.outerIndex *= 1.01;
        for (double& n : window.index)
            n *= 1.01;
        const std::vector<double> p = parametersOf(window);
        const Layers layers(window);
        const int count = layers.at().count;
        REQUIRE(count == (int)p.size());
        // On the axis, next to it, and anywhere.
        const double side = i == 0 ? 0 : i == 1 ? 1e-6 : 500;
        const Vec3d X = random.uniform(300, 900)*window.normal + side*directionAt(window.normal, CV_PI/2, random);
        Vec3d direction;
        std::vector<double> dX(9), dWindow(3*count);
        REQUIRE(solveInJacobian(layers, X, direction, dX.data(), dWindow.data()) == REFRACT_OK);

        Vec3d sameDirection;
        REQUIRE(solveIn(layers, X, 1, sameDirection) == REFRACT_OK);
        REQUIRE(norm(unit(direction) - unit(sameDirection)) < 1e-15);

        for (int c = 0; c < 3 + count; c++)
        {
            const bool isPoint = c < 3;
            const Vec3d column = isPoint ? Vec3d(dX[c], dX[3 + c], dX[6 + c])
                                         : Vec3d(dWindow[c - 3], dWindow[count + c - 3], dWindow[2*count + c - 3]);
            const Vec3d analytic = unitDerivative(direction, column);
            // Truncation falls, rounding rises with the step: one of the steps must fit.
            double best = INF;
            for (double step : { 1e-3, 1e-4, 1e-5, 1e-6 })
            {
                Vec3d Xs[2] = { X, X };
                std::vector<double> ps[2] = { p, p };
                for (int k = 0; k < 2; k++)
                    (isPoint ? Xs[k][c] : ps[k][c - 3]) += k ? -step : step;
                const Vec3d numeric = (unitDirection(ps[0], Xs[0]) - unitDirection(ps[1], Xs[1]))/(2*step);
                best = std::min(best, norm(numeric - analytic));
            }
            CAPTURE(i, c, analytic);
            REQUIRE(best < 3e-9*(1 + norm(analytic)));
        }
    }
}
