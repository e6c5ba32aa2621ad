// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Bent panes; in every call as two of allWindows().
#include "curved_scenes.hpp"
#include "quick_require.hpp"
#include "scenes.hpp"
#include "window/curved.hpp"
#include "window/curved_path.hpp"
#include "window/parameters.hpp"
#include "window/wedge.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

const Matx33d K = CURVED_K;

enum Lean { UPRIGHT, LEANING };

//! One to three layers, air or water outside; radii from 1.4 m on, mm.
GlassWindow randomBent(Random& random, Lean lean, double degrees = 25)
{
    GlassWindow window(randomNormal(random, degrees), random.uniform(2, 20), random.uniform(1.45, 1.8), random.uniform(5, 150),
                       random.below(2) ? 1 : 1.333);
    for (int layer = random.below(3); layer > 0; layer--)
    {
        window.thickness.push_back(random.uniform(1, 15));
        window.index.push_back(random.uniform(1.4, 1.7));
    }
    window.shape = WINDOW_BENT;
    window.curvature = (random.below(2) ? 1 : -1)/random.logUniform(1.4e3, 1e6);
    if (lean == LEANING)
        for (size_t i = 0; i < window.thickness.size(); i++)
            window.wedge.push_back(Vec2d(random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01)));
    return window;
}

//! Where a line first meets the sphere through h n with the normal m there, by the distance of its centre.
double stepTo(const Vec3d& point, const Vec3d& direction, const Vec3d& foot, const Vec3d& m, double curvature)
{
    const Vec3d off = point - foot;
    const double a = 0.5*curvature, b = (m + curvature*off).dot(direction), c = m.dot(off) + 0.5*curvature*off.dot(off);
    return -2*c/(b + std::sqrt(b*b - 4*a*c));
}

/** Vector Snell, sphere by sphere.
@return REFRACT_OK, or why light does not get out */
uchar trace(const GlassWindow& w, Vec3d& point, Vec3d& direction, double* leastCosine = nullptr)
{
    const Vec3d e1 = unit(Vec3d(1, 0, 0) - w.normal[0]*w.normal), e2 = w.normal.cross(e1);
    double medium = w.innerIndex, height = w.distance;
    Vec2d lean;
    point = Vec3d();
    if (!(direction.dot(w.normal) > 0))
        return REFRACT_BEHIND_WINDOW;
    for (size_t k = 0; k <= w.index.size(); k++)
    {
        const double next = k < w.index.size() ? w.index[k] : w.outerIndex, angle = norm(lean);
        const double curvature = w.curvature/(1 + w.curvature*(height - w.distance));
        const Vec3d foot = height*w.normal;
        const Vec3d towards = lean[0]*e1 + lean[1]*e2;
        const Vec3d m0 = angle > 0 ? std::cos(angle)*w.normal + std::sin(angle)/angle*towards : w.normal;
        const double s = stepTo(point, direction, foot, m0, curvature);
        if (!(s >= -1e-13*norm(point)))
            return REFRACT_BEHIND_WINDOW;
        point += s*direction;
        if (!refractAt(direction, m0 + curvature*(point - foot), medium, next, leastCosine))
            return REFRACT_TOTAL_REFLECTION;
        medium = next;
        if (k == w.index.size())
            break;
        height += w.thickness[k];
        lean += w.wedge.empty() ? Vec2d() : w.wedge[k];
    }
    return REFRACT_OK;
}

//! What the kernels see, made anew from a window.
struct Seen
{
    explicit Seen(const GlassWindow& window) : tangents(facesOf(window)), faces(bentFaces(window, tangents)), curved()
    {
        std::copy_n(windowAxes(window.normal).val, 9, curved.axes);
        curved.third = curved.normal[2] = 1;
        curved.faces = faces.data();
        curved.tangents = tangents.data();
        curved.count = (int)faces.size();
        curved.inner = window.innerIndex;
        curved.outer = window.outerIndex;
        curved.least = window.wedge.empty() ? -INF : 0;
        curved.at = windowLayout(window);
    }
    std::vector<Face> tangents;
    std::vector<CurvedFace> faces;
    CurvedFaces curved;
};

//! In the camera, at most this angle from the window's normal.
Vec3d randomRay(Random& random, const GlassWindow& window, double mostAngle)
{
    const Vec3d side = unit(window.normal.cross(random.vector(1)));
    const double angle = random.uniform(0, mostAngle);
    return std::cos(angle)*window.normal + std::sin(angle)*side;
}

std::vector<Point3d> somePoints(Random& random, int count)
{
    std::vector<Point3d> points;
    for (int i = 0; i < count; i++)
        points.push_back(Point3d(random.uniform(-300, 300), random.uniform(-300, 300), random.uniform(400, 1000)));
    return points;
}

} // namespace

TEST_CASE("Round trips through bent panes, with and without a wedge", "[bent]")
{
    CAPTURE(seed());
    Random random;
    double worst = 0, worstScalar = 0;
    int trips = 0, left = 0;
    for (int i = 0; i < 20000; i++)
    {
        const Lean lean = i % 2 ? LEANING : UPRIGHT;
        const GlassWindow window = randomBent(random, lean, 60);
        const Layers layers(window);
        const Vec3d w = randomRay(random, window, 1.55);
        Vec3d point, direction = w, back;
        double grazing = 1;
        const uchar expected = trace(window, point, direction, &grazing);
        Rays rays;
        uchar status = REFRACT_OK;
        layers.traceOut(1, &w[0], &w[1], &w[2], rays, &status);
        QUICK_REQUIRE(status == expected, i, w, grazing);
        if (expected != REFRACT_OK || grazing < 2e-2)
            continue;
        QUICK_REQUIRE(norm(rays.direction(0) - direction) < 1e-14/(grazing*grazing), i, w);
        const Vec3d origin = rays.origin(0, layers.normal());
        QUICK_REQUIRE(norm((origin - point).cross(direction)) < 1e-13*(norm(point) + norm(origin))/(grazing*grazing), i, w);
        const double mu = layers.leavingMu(rays, 0);
        QUICK_REQUIRE(norm(origin + rays.direction(0)/mu - point) < 1e-12*(norm(point) + norm(origin))/(grazing*grazing), i, w);
        // Within the sphere where its centre is ahead: light that grazes it leaves it again, and behind its focus there are several images.
        const double far = random.logUniform(0.01, window.curvature > 0 ? 1e4 : std::min(1e4, -0.3*grazing/window.curvature));
        const Vec3d X = point + far*direction;
        QUICK_REQUIRE(layers.isBeyond(X[0], X[1], X[2]), i, w, window.curvature, far);
        QUICK_REQUIRE(!layers.isBeyond(0.999*point[0], 0.999*point[1], 0.999*point[2]), i, w);
        QUICK_REQUIRE(solveIn(layers, X, 1, back) == REFRACT_OK, i, w, X);
        const double error = norm(unit(back) - w)*grazing*grazing;
        QUICK_REQUIRE(error < 1e-13, i, w, X, error);
        worst = std::max(worst, error);
        // The scalar code and the kernel are two ways to one answer; and homogeneous points.
        const Seen seen(window);
        const Matx33d axes(seen.curved.axes);
        Vec3d scalar = w;
        left += !curvedKernels().solveIn(seen.curved, 1, &X[0], &X[1], &X[2], NULL, &scalar[0], &scalar[1], &scalar[2]);
        QUICK_REQUIRE(findBentPath(seen.curved, axes*X, 1, scalar) == REFRACT_OK, i, w, X, grazing,
                      (int)findBentPath(seen.curved, axes*X, 1, scalar), axes*w);
        worstScalar = std::max(worstScalar, norm(unit(axes.t()*scalar) - w)*grazing*grazing);
        QUICK_REQUIRE(solveIn(layers, X*1e-4, 1e-4, back) == REFRACT_OK, i, w, X);
        QUICK_REQUIRE(norm(unit(back) - w)*grazing*grazing < 1e-13, i, w, X);
        trips++;
        if (window.curvature < 0)
            continue;
        QUICK_REQUIRE(solveIn(layers, direction, 0, back) == REFRACT_OK, i, w, (int)solveIn(layers, direction, 0, back), grazing,
                      1/window.curvature, window.normal.dot(w), window.normal.dot(direction));
        QUICK_REQUIRE(norm(unit(back) - w)*grazing*grazing < 1e-13, i, w, norm(unit(back) - w)*grazing*grazing);
        QUICK_REQUIRE(findBentPath(seen.curved, axes*direction, 0, scalar) == REFRACT_OK, i, w, X);
        worstScalar = std::max(worstScalar, norm(unit(axes.t()*scalar) - w)*grazing*grazing);
    }
    CHECK(trips > 12000);
    CHECK(left < trips/100);
    CHECK(worstScalar < 1e-12);
    printNumber("round trips through bent panes", trips, "");
    printNumber("round trips through bent panes, worst angle * cos(grazing angle)^2", worst, "rad");
    printNumber("round trips through bent panes by scalar code, worst angle * cos(grazing angle)^2", worstScalar, "rad");
    printNumber("points that the kernel leaves to scalar code", left, "");
}

TEST_CASE("A bent pane without curvature is flat, and there is no jump", "[bent]")
{
    CAPTURE(seed());
    Random random;
    for (int i = 0; i < 20; i++)
    {
        GlassWindow bent = randomBent(random, i % 2 ? LEANING : UPRIGHT), flat = bent;
        flat.shape = WINDOW_FLAT;
        flat.curvature = 0;
        const std::vector<Point3d> points = somePoints(random, 50);
        std::vector<Point2d> pixels, expected;
        std::vector<Point3d> origins, directions, flatOrigins, flatDirections;
        std::vector<uchar> status;
        Mat J, flatJ;
        refractiveProjectPoints(points, Vec3d(), Vec3d(), RefractiveCamera::create(K, noArray(), flat), expected, status, flatJ);
        refractiveUnprojectPoints(expected, flatOrigins, flatDirections, K, noArray(), flat);
        for (double curvature : { 0., 1e-300, 1e-20, -1e-20 })
        {
            CAPTURE(i, curvature);
            bent.curvature = curvature;
            const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, noArray(), bent);
            refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels, status, J);
            refractiveUnprojectPoints(expected, origins, directions, camera);
            REQUIRE(largestDifference(pixels, expected) <= (curvature == 0 ? 0 : 1e-10));
            REQUIRE(largestDifference(origins, flatOrigins) <= (curvature == 0 ? 0 : 1e-12));
            REQUIRE(largestDifference(directions, flatDirections) <= (curvature == 0 ? 0 : 1e-14));
            REQUIRE(J.cols == flatJ.cols + 1);
            for (int c = 0; c < flatJ.cols; c++)
                REQUIRE(largestDifference(J.col(c), flatJ.col(c)) <= 1e-9*(1 + norm(flatJ.col(c), NORM_INF)));
        }
        // And the derivative by the curvature says what a small one does.
        const double small = 1e-8;
        std::vector<Point2d> above, below;
        bent.curvature = small;
        refractiveProjectPoints(points, Vec3d(), Vec3d(), K, noArray(), bent, above);
        bent.curvature = -small;
        refractiveProjectPoints(points, Vec3d(), Vec3d(), K, noArray(), bent, below);
        bent.curvature = 0;
        refractiveProjectPoints(points, Vec3d(), Vec3d(), RefractiveCamera::create(K, noArray(), bent), pixels, status, J);
        for (size_t k = 0; k < points.size(); k++)
        {
            const Vec2d expectedRow((above[k].x - below[k].x)/(2*small), (above[k].y - below[k].y)/(2*small));
            const Vec2d row(J.at<double>(2*(int)k, J.cols - 1), J.at<double>(2*(int)k + 1, J.cols - 1));
            REQUIRE(norm(row - expectedRow) < 1e-4*(1 + 1e-2*norm(row)));
            REQUIRE(norm(row) > 1e-3);
        }
    }
}

TEST_CASE("A bent pane is a dome of the same spheres", "[bent]")
{
    CAPTURE(seed());
    Random random;
    for (int i = 0; i < 200; i++)
    {
        GlassWindow bent = randomBent(random, UPRIGHT);
        bent.curvature = 1/random.uniform(300, 3000);
        const double radius = 1/bent.curvature;
        GlassWindow dome = GlassWindow::dome((bent.distance - radius)*bent.normal, radius, bent.thickness[0], bent.index[0],
                                             bent.outerIndex);
        dome.thickness = bent.thickness;
        dome.index = bent.index;
        const std::vector<Point3d> points = somePoints(random, 20);
        std::vector<Point2d> behind, expected;
        refractiveProjectPoints(points, Vec3d(), Vec3d(), K, noArray(), bent, behind);
        refractiveProjectPoints(points, Vec3d(), Vec3d(), K, noArray(), dome, expected);
        CAPTURE(i, radius);
        REQUIRE(largestDifference(behind, expected) < 1e-9);
        std::vector<Point3d> origins, directions, domeOrigins, domeDirections;
        refractiveUnprojectPoints(expected, origins, directions, K, noArray(), bent);
        refractiveUnprojectPoints(expected, domeOrigins, domeDirections, K, noArray(), dome);
        REQUIRE(largestDifference(directions, domeDirections) < 1e-13);
        for (size_t k = 0; k < points.size(); k++)
            REQUIRE(norm((origins[k] - domeOrigins[k]).cross(directions[k])) < 1e-10);
    }
}

TEST_CASE("A pane that bends towards the camera shows what lies behind its sphere, too", "[bent]")
{
    CAPTURE(seed());
    Random random;
    int inside = 0, behind = 0, several = 0;
    for (int i = 0; i < 20000; i++)
    {
        GlassWindow window = randomBent(random, i % 2 ? LEANING : UPRIGHT, 40);
        window.distance = random.uniform(0, 50);
        window.curvature = -1/random.logUniform(2e3, 1e6);
        const Layers layers(window);
        const Vec3d w = randomRay(random, window, 1.4);
        Vec3d point, direction = w, back;
        double grazing = 1;
        if (trace(window, point, direction, &grazing) != REFRACT_OK || grazing < 0.1)
            continue;
        const double radius = -1/window.curvature, way = radius*random.logUniform(1e-3, 1e3);
        const Vec3d X = point + way*direction, centre = (window.distance + radius)*window.normal;
        (norm(X - centre) < radius ? inside : behind)++;
        QUICK_REQUIRE(layers.isBeyond(X[0], X[1], X[2]), i, X, w);
        QUICK_REQUIRE(solveIn(layers, X, 1, back) == REFRACT_OK, i, X, w);
        if (norm(unit(back) - w)*grazing*grazing >= 1e-12)      // of several images any is right
        {
            Vec3d leaving, along = unit(back);
            QUICK_REQUIRE(trace(window, leaving, along) == REFRACT_OK, i, X, w);
            QUICK_REQUIRE(norm((X - leaving).cross(along)) < 1e-9*norm(X), i, X, w, norm((X - leaving).cross(along)));
            QUICK_REQUIRE((X - leaving).dot(along) > 0, i, X, w);
            several++;
        }
        QUICK_REQUIRE(solveIn(layers, direction, 0, back) == REFRACT_OK, i, X, w);
        // A ray meets what it comes to behind the pane: before it, beside the sphere, there is nothing.
        Rays rays;
        uchar status = REFRACT_OK;
        layers.traceOut(1, &w[0], &w[1], &w[2], rays, &status);
        const Vec3d d = rays.direction(0), before = point - random.logUniform(1e-2, 0.3)*norm(point)*d;
        QUICK_REQUIRE(isBeyondAlong(layers.lastSurface(), X[0], X[1], X[2], 1., d[0], d[1], d[2]), i, X);
        QUICK_REQUIRE((!isBeyondAlong(layers.lastSurface(), before[0], before[1], before[2], 1., d[0], d[1], d[2])), i, before);
        // The same seen from elsewhere.
        const Matx33d R(windowAxes(randomNormal(random, 60)).val);
        const Vec3d t = random.vector(radius), moved = R.t()*(X - t), d2 = R.t()*d;
        const Surface elsewhere = inFrame(layers.lastSurface(), R.val, t.val);
        QUICK_REQUIRE(isBeyond(elsewhere, moved[0], moved[1], moved[2], 1.) == isBeyond(layers.lastSurface(), X[0], X[1], X[2], 1.), i, X);
        QUICK_REQUIRE((isBeyondAlong(elsewhere, moved[0], moved[1], moved[2], 1., d2[0], d2[1], d2[2])), i, X);
    }
    CHECK(inside > 1000);
    CHECK(behind > 1000);
    CHECK(several < 100);
    printNumber("points behind a pane that bends towards the camera with another image", several, "");
    // And beside it, where no light through it goes: what is not beyond is behind the window.
    const GlassWindow window = [] { GlassWindow w(Vec3d(0, 0, 1), 10, 1.52, 30); w.shape = WINDOW_BENT; w.curvature = -1e-3; return w; }();
    for (const Vec3d& X : { Vec3d(0, 0, 20), Vec3d(3000, 0, 45), Vec3d(0, -5000, -3000), Vec3d(0, 0, -1e5) })
    {
        Vec3d d;
        CAPTURE(X);
        CHECK(!Layers(window).isBeyond(X[0], X[1], X[2]));
        CHECK(solveIn(Layers(window), X, 1, d) == REFRACT_BEHIND_WINDOW);
    }
}

TEST_CASE("Points behind the sphere of a pane, and beside it, are triangulated", "[bent][triangulate]")
{
    GlassWindow window(Vec3d(0, 0, 1), 10, 1.5, 50);
    window.shape = WINDOW_BENT;
    window.curvature = -1e-3;
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createFisheye(Matx33d(500, 0, 900, 0, 500, 900, 0, 0, 1), noArray(), window);
    const std::vector<Vec3d> points = { { 10, 20, 500 }, { 3000, 0, 5000 }, { -2000, 9000, 6000 }, { 1500, 0, 500 } };
    const Vec3d rvec, tvec(-20, 0, 0);
    std::vector<Vec2d> pixels1, pixels2;
    std::vector<Vec3d> found;
    std::vector<uchar> status;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels1);
    refractiveProjectPoints(points, rvec, tvec, camera, pixels2);
    for (int flags : { 0, (int)TRIANGULATE_MIDPOINT })
    {
        triangulateRefractive(camera, camera, rvec, tvec, pixels1, pixels2, found, status, flags);
        CAPTURE(flags);
        CHECK(status == std::vector<uchar>(4, REFRACT_OK));
        CHECK(largestDifference(found, points) < 1e-4);
    }
}

TEST_CASE("What a pane that bends towards the camera hides has a status", "[bent]")
{
    // A sphere of radius 1000 whose centre is 1050 ahead; the camera sees up to 72 degrees of it.
    GlassWindow window(Vec3d(0, 0, 1), 10, 1.5, 50);
    window.shape = WINDOW_BENT;
    window.curvature = -1e-3;
    const Layers layers(window);
    Vec3d d;
    CHECK(solveIn(layers, Vec3d(0, 0, 500), 1, d) == REFRACT_OK);
    CHECK(solveIn(layers, Vec3d(0, 0, 5000), 1, d) == REFRACT_OK);
    CHECK(solveIn(layers, Vec3d(0, 0, 1), 0, d) == REFRACT_OK);
    CHECK(unit(d)[2] == 1);
    CHECK(solveIn(layers, Vec3d(0, 0, 55), 1, d) == REFRACT_BEHIND_WINDOW);
    CHECK(solveIn(layers, Vec3d(1500, 0, 300), 1, d) == REFRACT_BEHIND_WINDOW);     // beside the sphere, not behind it
    CHECK(!layers.isBeyond(1500, 0, 300));
    // The straight way misses the sphere by 6, but the glass bends light so far.
    const Vec3d beside(1500, 0, 500);
    CHECK(layers.isBeyond(beside[0], beside[1], beside[2]));
    CHECK(solveIn(layers, beside, 1, d) == REFRACT_OK);
    Vec3d leaving, along = unit(d);
    CHECK(trace(window, leaving, along) == REFRACT_OK);
    CHECK(norm((beside - leaving).cross(along)) < 1e-9);
    CHECK((beside - leaving).dot(along) > 0);
    CHECK(solveIn(layers, Vec3d(0, 0, -1), 0, d) == REFRACT_BEHIND_WINDOW);
    CHECK(solveIn(layers, Vec3d(1, 0, 1e-3), 0, d) != REFRACT_OK);
    for (double degrees : { 70., 71., 73., 89., 91., 180. })
    {
        const Vec3d w(std::sin(degrees*CV_PI/180), 0, std::cos(degrees*CV_PI/180));
        Rays rays;
        uchar status = REFRACT_OK;
        layers.traceOut(1, &w[0], &w[1], &w[2], rays, &status);
        CAPTURE(degrees);
        // 1050 sin(angle) is kept by all spheres: beyond 990 light does not get out of the glass, beyond 1000 not into it.
        CHECK(status == (degrees < 70.5 ? REFRACT_OK : degrees < 72 ? REFRACT_TOTAL_REFLECTION : REFRACT_BEHIND_WINDOW));
        CHECK(std::isnan(rays.tau[0]) == (status != REFRACT_OK));
    }
    const std::vector<Point3d> points = { { NAN, 0, 100 }, { 0, 0, 40 }, { 10, 20, 300 } };
    std::vector<Point2d> pixels;
    std::vector<uchar> status;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), K, noArray(), window, pixels, status);
    CHECK(status == std::vector<uchar>{ REFRACT_NOT_FINITE, REFRACT_BEHIND_WINDOW, REFRACT_OK });
    CHECK(std::isnan(pixels[1].y));
}

TEST_CASE("Bent panes of 1e-3 and 1e3 of glass", "[bent]")
{
    CAPTURE(seed());
    Random random;
    for (double thickness : { 0., 1e-3, 1e3 })
        for (double curvature : { 2e-5, -2e-5, 9e-4, -2e-4 })
            for (int i = 0; i < 50; i++)
            {
                GlassWindow window(randomNormal(random, 30), thickness, 1.5, 30, random.below(2) ? 1 : 1.333);
                window.shape = WINDOW_BENT;
                window.curvature = curvature;
                const Vec3d X = (1.1*thickness + random.uniform(200, 400))*unit(window.normal + random.vector(0.3));
                CAPTURE(thickness, curvature, X);
                Vec3d d, point;
                REQUIRE(solveIn(Layers(window), X, 1, d) == REFRACT_OK);
                Vec3d direction = unit(d);
                REQUIRE(trace(window, point, direction) == REFRACT_OK);
                REQUIRE(norm((X - point).cross(direction)) < 1e-11*norm(X));
            }
}

TEST_CASE("Every instruction set gives the same answer behind a bent pane", "[bent][kernels]")
{
    CAPTURE(seed());
    Random random;
    for (int i = 0; i < 20; i++)
    {
        const GlassWindow window = randomBent(random, i % 2 ? LEANING : UPRIGHT);
        std::vector<Vec3d> points;
        for (int k = 0; k < 301; k++)
            points.push_back(random.uniform(300, 800)*unit(window.normal + random.vector(0.5)));
        checkInstructionSets(Seen(window).curved, points, window.distance);
    }
}

TEST_CASE("What is no bent pane is refused, and the text says why", "[bent]")
{
    const auto text = [](const std::function<void(GlassWindow&)>& change, int code)
    {
        GlassWindow window(Vec3d(0.1, 0, 1), 10, 1.5, 40);
        window.shape = WINDOW_BENT;
        window.curvature = 1e-5;
        change(window);
        return refusal([&] { window.check(); }, code);
    };
    const int range = Error::StsOutOfRange, bad = Error::StsBadArg;
    CHECK_THAT(text([](GlassWindow&) {}, range), Contains("no refusal"));
    CHECK_THAT(text([](GlassWindow& w) { w.curvature = 0.02; }, range), Contains("window.curvature is 0.02, a radius of 50"));
    CHECK_THAT(text([](GlassWindow& w) { w.curvature = -0.021; }, range), Contains("window.curvature is -0.021"));
    CHECK_THAT(text([](GlassWindow& w) { w.curvature = NAN; }, range), Contains("window.curvature is nan"));
    CHECK_THAT(text([](GlassWindow& w) { w.curvature = INF; w.distance = w.thickness[0] = 0; }, range), Contains("curvature is inf"));
    CHECK_THAT(text([](GlassWindow& w) { w.radius = 5; }, bad), Contains("window.radius is set, but the window is a bent pane"));
    CHECK_THAT(text([](GlassWindow& w) { w.center[0] = 5; }, bad), Contains("window.center is set, but the window is a bent pane"));
    CHECK_THAT(text([](GlassWindow& w) { w.axis[0] = 1; }, bad), Contains("window.axis is set, but the window is a bent pane"));
    CHECK_THAT(text([](GlassWindow& w) { w.normal = Vec3d(0, 0, -1); }, bad), Contains("window.normal"));
    CHECK_THAT(text([](GlassWindow& w) { w.shape = WINDOW_FLAT; }, bad), Contains("window.curvature is set, but the window is flat"));
}

TEST_CASE("A bent pane is the same after its file", "[bent][file]")
{
    GlassWindow bent(Vec3d(0, 0, 1), 7.3, 1.5168, 40, 1.333);
    bent.shape = WINDOW_BENT;
    bent.curvature = -1.25e-5;
    bent.wedge.push_back(Vec2d(0.001, -0.002));
    String text;
    const GlassWindow back = throughFile(bent, text);
    CHECK_THAT(text, Contains("shape: bent"));
    CHECK(back.shape == WINDOW_BENT);
    CHECK(back.curvature == bent.curvature);
    CHECK(back.wedge == bent.wedge);
    CHECK(back.normal == bent.normal);
    CHECK(back.distance == bent.distance);
    CHECK(windowParameterNames(windowLayout(back)).back() == "curvature");
    CHECK(windowParameters(back).back() == bent.curvature);
}

TEST_CASE("Two cameras may look through one bent pane", "[bent]")
{
    CAPTURE(seed());
    Random random;
    for (int i = 0; i < 200; i++)
    {
        const GlassWindow window = randomBent(random, UPRIGHT);
        Matx33d R;
        Rodrigues(random.vector(0.2), R);
        const Vec3d T = random.vector(4);
        const GlassWindow other = windowInFrame(window, R, T);
        CHECK(other.thickness == window.thickness);
        CHECK(other.curvature == window.curvature);
        const Layers here(window), there(other);
        const Surface moved = inFrame(there.lastSurface(), R.val, T.val);
        CHECK(moved.distance == Approx(here.lastSurface().distance).epsilon(1e-12));
        CHECK(norm(Vec3d(moved.normal) - Vec3d(here.lastSurface().normal)) < 1e-12);
    }
    GlassWindow leaning = randomBent(random, LEANING);
    CHECK_THAT(refusal([&] { windowInFrame(leaning, Matx33d::eye(), Vec3d(1, 0, 0)); }, Error::StsNotImplemented), Contains("wedge"));
}
