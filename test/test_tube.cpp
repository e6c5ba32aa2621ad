// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Tubes; against 60-digit references in test_reference.cpp, in every call as two of allWindows().
#include "curved_scenes.hpp"
#include "quick_require.hpp"
#include "window/curved.hpp"
#include "window/curved_path.hpp"
#include "window/parameters.hpp"
#include "window/wedge.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

/** One to three layers; the axis up to 0.6 radii off.
@param anyMedia round the camera, too, and the axis up to 0.95 radii off: there may be total reflection and caustics */
GlassWindow randomTube(Random& random, bool anyMedia)
{
    const double radius = random.logUniform(5, 500);
    const Vec3d axis = unit(random.vector(1)), towards = unit(across(random.vector(1), axis));
    const double media[] = { 1, 1.333, 1.5 };
    GlassWindow window = GlassWindow::tube(random.uniform(0, anyMedia ? 0.95 : 0.6)*radius*towards + random.uniform(-9, 9)*axis, axis,
                                           radius, radius*random.uniform(0.01, 0.5), random.uniform(1.45, 1.8), media[random.below(2)]);
    window.center += random.uniform(-1, 1)*radius*window.axis;      // without effect
    for (int layer = random.below(3); layer > 0; layer--)
    {
        window.thickness.push_back(radius*random.uniform(0.01, 0.2));
        window.index.push_back(random.uniform(1.3, 1.7));
    }
    if (anyMedia)
        window.innerIndex = media[random.below(3)];
    return window;
}

//! Vector Snell, cylinder by cylinder. @return false: total reflection
bool trace(const GlassWindow& w, Vec3d& point, Vec3d& direction, double* leastCosine = nullptr)
{
    double medium = w.innerIndex, radius = w.radius;
    point = Vec3d();
    for (size_t k = 0; k <= w.index.size(); k++)
    {
        const double next = k < w.index.size() ? w.index[k] : w.outerIndex;
        const Vec3d off = across(point - w.center, w.axis), d = across(direction, w.axis);
        const double ahead = off.dot(d)/d.dot(d);
        point += (-ahead + std::sqrt(ahead*ahead - (off.dot(off) - radius*radius)/d.dot(d)))*direction;
        if (!refractAt(direction, across(point - w.center, w.axis)/radius, medium, next, leastCosine))
            return false;
        medium = next;
        radius += k < w.index.size() ? w.thickness[k] : 0;
    }
    return true;
}

//! What the kernels see, made anew from a window.
struct Seen
{
    explicit Seen(const GlassWindow& window) : faces(tubeFaces(window)), curved()
    {
        const Matx33d axes = tubeAxes(window.axis);
        const Vec3d center = axes*window.center;
        std::copy_n(axes.val, 9, curved.axes);
        std::copy_n(center.val, 3, curved.center);
        curved.normal[0] = 1;
        curved.least = -INF;
        curved.faces = faces.data();
        curved.count = (int)faces.size();
        curved.inner = window.innerIndex;
        curved.outer = window.outerIndex;
        curved.at = windowLayout(window);
    }
    std::vector<CurvedFace> faces;
    CurvedFaces curved;
};

GlassWindow changed(const std::function<void(GlassWindow&)>& change)
{
    GlassWindow window = GlassWindow::tube(Vec3d(10, 2, 3), Vec3d(0.1, 1, 0), 50, 5, 1.5);
    change(window);
    return window;
}

} // namespace

TEST_CASE("Round trips through tubes, to all sides, of any media", "[tube]")
{
    CAPTURE(seed());
    Random random;
    double worst = 0;
    int trips = 0, reflected = 0, several = 0, left[2] = {};      // left: of the usual media, of any
    for (int i = 0; i < 40000; i++)
    {
        const GlassWindow window = randomTube(random, i % 2 == 1);
        const Layers layers(window);
        const Vec3d w = unit(random.vector(1));
        const double size = window.radius, side = norm(across(w, window.axis));
        if (side < 1e-2)
            continue;
        Vec3d point, direction = w, back;
        double grazing = side;
        const bool gets = trace(window, point, direction, &grazing);
        Rays rays;
        uchar status = REFRACT_OK;
        layers.traceOut(1, &w[0], &w[1], &w[2], rays, &status);
        QUICK_REQUIRE(status == (gets ? REFRACT_OK : REFRACT_TOTAL_REFLECTION), i, w, grazing);
        reflected += !gets;
        if (!gets || grazing < 1e-2)
            continue;
        QUICK_REQUIRE(norm(rays.direction(0) - direction) < 1e-14/(grazing*grazing), i, w);
        const Vec3d origin = rays.origin(0, layers.normal());
        QUICK_REQUIRE(norm((origin - point).cross(direction)) < 1e-13*(norm(point) + norm(origin))/(grazing*grazing), i, w);
        QUICK_REQUIRE(std::abs(origin.dot(window.axis)) < 1e-12*(size + norm(origin)), i, w);
        const double mu = layers.leavingMu(rays, 0);
        QUICK_REQUIRE(norm(origin + rays.direction(0)/mu - point) < 1e-12*(norm(point) + norm(origin))/(grazing*grazing), i, w);
        const Vec3d X = point + size*random.logUniform(1e-2, 1e4)*direction;
        QUICK_REQUIRE(layers.isBeyond(X[0], X[1], X[2]), i, w);
        const Vec3d foot = window.center + (point - window.center).dot(window.axis)*window.axis, inside = foot + 0.999*(point - foot);
        QUICK_REQUIRE(!layers.isBeyond(inside[0], inside[1], inside[2]), i, w);
        const Seen seen(window);
        Vec3d kernel = X;
        left[i % 2] += !curvedKernels().solveIn(seen.curved, 1, &X[0], &X[1], &X[2], NULL, &kernel[0], &kernel[1], &kernel[2]);
        QUICK_REQUIRE(solveIn(layers, X, 1, back) == REFRACT_OK, i, w, X);
        const double error = norm(unit(back) - w)*grazing*grazing;
        const bool isRarest = isInnerRarest(window);
        if (error >= 1e-13 && !isRarest)
        {
            // Next to a caustic two directions see the point, and behind it more: any of them is right.
            Vec3d again, leaving = unit(back);
            double grazingBack = 1;
            QUICK_REQUIRE(trace(window, again, leaving, &grazingBack), i, w, X);
            QUICK_REQUIRE(norm((X - again).cross(leaving))*grazingBack < 1e-10*norm(X), i, w, X, grazingBack);
            several++;
            continue;
        }
        QUICK_REQUIRE(error < 1e-13, i, w, X, error);
        worst = std::max(worst, error);
        // The scalar code and the kernel are two ways to one answer; and homogeneous points.
        const Matx33d axes(seen.curved.axes);
        Vec3d scalar;
        QUICK_REQUIRE(findTubePath(seen.curved, axes*X, 1, scalar) == REFRACT_OK, i, w, X);
        QUICK_REQUIRE((!isRarest || norm(unit(axes.t()*scalar) - w)*grazing*grazing < 1e-12), i, w, X, norm(unit(axes.t()*scalar) - w));
        QUICK_REQUIRE(solveIn(layers, X*1e-4, 1e-4, back) == REFRACT_OK, i, w, X);
        QUICK_REQUIRE((!isRarest || norm(unit(back) - w)*grazing*grazing < 1e-13), i, w, X);
        QUICK_REQUIRE(solveIn(layers, direction, 0, back) == REFRACT_OK, i, w, grazing, isRarest, (int)solveIn(layers, direction, 0, back));
        QUICK_REQUIRE((!isRarest || norm(unit(back) - w)*grazing*grazing < 1e-13), i, w);
        QUICK_REQUIRE(findTubePath(seen.curved, axes*direction, 0, scalar) == REFRACT_OK, i, w, X);
        trips++;
    }
    CHECK(trips > 25000);
    CHECK(reflected > 100);
    CHECK(left[0] < trips/1000);
    CHECK(left[1] < trips/20);
    printNumber("round trips through tubes", trips, "");
    printNumber("round trips through tubes, worst angle * cos(grazing angle)^2", worst, "rad");
    printNumber("points that the kernel leaves to scalar code, camera in the rarest medium", left[0], "");
    printNumber("points that the kernel leaves to scalar code, any media, next to the wall", left[1], "");
    printNumber("points with another image than the one they were made from", several, "");
}

TEST_CASE("Where a tube's cross-section loses light, a point that has a path is seen", "[tube]")
{
    // The camera near the wall of a tube of a dense medium, air outside: paths go by the centre.
    CAPTURE(seed());
    Random random;
    int trips = 0, byCenter = 0;
    for (int i = 0; i < 30000; i++)
    {
        const double radius = random.logUniform(5, 500);
        const Vec3d axis = unit(random.vector(1)), towards = unit(across(random.vector(1), axis));
        GlassWindow window = GlassWindow::tube(random.uniform(0.4, 0.98)*radius*towards, axis, radius, radius*random.uniform(0.01, 0.5),
                                               random.uniform(1.3, 1.9), random.below(3) ? 1 : 1.333);
        window.innerIndex = random.uniform(1.2, 1.7);
        const Layers layers(window);
        const Vec3d w = unit(random.vector(1));
        Vec3d point, direction = w, back;
        double grazing = norm(across(w, axis));
        if (grazing < 1e-2 || !trace(window, point, direction, &grazing) || grazing < 1e-2)
            continue;
        const Vec3d X = point + radius*random.logUniform(1e-2, 1e6)*direction;
        QUICK_REQUIRE(solveIn(layers, X, 1, back) == REFRACT_OK, i, w, X, grazing);
        Vec3d again, leaving = unit(back);      // of several images any is right
        double grazingBack = 1;
        QUICK_REQUIRE(trace(window, again, leaving, &grazingBack), i, w, X);
        QUICK_REQUIRE(norm((X - again).cross(leaving))*grazingBack*grazingBack < 1e-9*norm(X), i, w, X, grazingBack);
        QUICK_REQUIRE((X - again).dot(leaving) > 0, i, w, X);
        trips++;
        byCenter += across(w, axis).dot(towards) > 0;
    }
    CHECK(trips > 10000);
    CHECK(byCenter > 2000);
}

TEST_CASE("In its cross-section a tube is a dome", "[tube]")
{
    CAPTURE(seed());
    Random random;
    for (int i = 0; i < 2000; i++)
    {
        GlassWindow tube = randomTube(random, false), dome = tube;
        tube.center = across(tube.center, tube.axis);
        dome = GlassWindow::dome(tube.center, tube.radius, tube.thickness[0], tube.index[0], tube.outerIndex);
        dome.thickness = tube.thickness;
        dome.index = tube.index;
        const Vec3d X = tube.center + 2.5*tube.radius*random.logUniform(1, 100)*unit(across(random.vector(1), tube.axis));
        Vec3d inTube, inDome;
        QUICK_REQUIRE(solveIn(Layers(tube), X, 1, inTube) == REFRACT_OK, i, X);
        QUICK_REQUIRE(solveIn(Layers(dome), X, 1, inDome) == REFRACT_OK, i, X);
        QUICK_REQUIRE(norm(unit(inTube) - unit(inDome)) < 1e-13, i, X, norm(unit(inTube) - unit(inDome)));
    }
}

TEST_CASE("A camera on a tube's axis sees planes of the axis as through a pane", "[tube]")
{
    // The plane of a ray and the axis cuts the faces in parallel lines: a pane across the ray's part across the axis.
    CAPTURE(seed());
    Random random;
    for (int i = 0; i < 2000; i++)
    {
        GlassWindow tube = randomTube(random, false);
        tube.center = random.uniform(-1, 1)*tube.radius*tube.axis;
        const Vec3d n = unit(across(random.vector(1), tube.axis));
        GlassWindow pane(Vec3d(0, 0, 1), tube.thickness[0], tube.index[0], tube.radius, tube.outerIndex);
        pane.thickness = tube.thickness;
        pane.index = tube.index;
        pane.normal = n[2] > 0 ? n : -n;
        const double far = 2.5*tube.radius*random.logUniform(1, 100);
        const Vec3d X = far*pane.normal + far*random.uniform(-3, 3)*tube.axis;
        Vec3d inTube, behind;
        QUICK_REQUIRE(solveIn(Layers(tube), X, 1, inTube) == REFRACT_OK, i, X);
        QUICK_REQUIRE(solveIn(Layers(pane), X, 1, behind) == REFRACT_OK, i, X);
        QUICK_REQUIRE(norm(unit(inTube) - unit(behind)) < 1e-13, i, X, norm(unit(inTube) - unit(behind)));
    }
}

TEST_CASE("A tube becomes a flat window as its radius grows", "[tube]")
{
    CAPTURE(seed());
    checkLimitOfRadius("tube", [](const GlassWindow& flat, double radius)
    {
        return GlassWindow::tube(-(radius - flat.distance)*flat.normal, flat.normal.cross(Vec3d(1, 0, 0)), radius, flat.thickness[0],
                                 flat.index[0], flat.outerIndex);
    });
}

TEST_CASE("Thin and thick tubes, far along the axis and next to the wall", "[tube]")
{
    CAPTURE(seed());
    Random random;
    for (double thickness : { 0., 1e-3, 1e3 })
        for (double offset : { 0., 49.99 })
            for (double outerIndex : { 1., 1.333 })
                for (double up : { 0., 1e-9, 10., 1e5, 1e7 })
                {
                    const GlassWindow window = GlassWindow::tube(Vec3d(offset, 0, 0), Vec3d(0, 1, 0), 50, thickness, 1.5, outerIndex);
                    const Layers layers(window);
                    const double angle = random.uniform(0, 2*CV_PI), far = (50 + thickness)*random.uniform(1.1, 20);
                    const Vec3d X(offset + far*std::cos(angle), up, far*std::sin(angle));
                    CAPTURE(thickness, offset, outerIndex, X);
                    Vec3d d;
                    REQUIRE(solveIn(layers, X, 1, d) == REFRACT_OK);
                    Vec3d point, direction = unit(d);
                    double grazing = 1;
                    REQUIRE(trace(window, point, direction, &grazing));
                    REQUIRE(norm((X - point).cross(direction)) < 1e-15*norm(X)/grazing);
                    REQUIRE((X - point).dot(direction) > 0);
                }
}

TEST_CASE("No light goes along a tube's axis, and none comes from inside it", "[tube]")
{
    const GlassWindow window = GlassWindow::tube(Vec3d(5, -4, 12), Vec3d(0.3, -0.2, 1), 50, 7, 1.5, 1.333);
    const Layers layers(window);
    Vec3d d;
    for (double side : { 1., -1. })
    {
        const Vec3d w = side*window.axis;
        Rays rays;
        uchar status = REFRACT_OK;
        layers.traceOut(1, &w[0], &w[1], &w[2], rays, &status);
        CHECK(status == REFRACT_BEHIND_WINDOW);
        CHECK(std::isnan(rays.tau[0]));
        CHECK(solveIn(layers, w, 0, d) == REFRACT_BEHIND_WINDOW);
        CHECK(std::isnan(d[0]));
        CHECK(solveIn(layers, 1e6*w, 1, d) == REFRACT_BEHIND_WINDOW);
        CHECK(std::isnan(d[0]));
    }
    CAPTURE(seed());
    Random random;
    std::vector<Point3d> points;
    std::vector<uchar> expected;
    for (int i = 0; i < 1000; i++)
    {
        const Vec3d at = unit(across(random.vector(1), window.axis));
        const double radius = (i % 3 == 0 ? 1 + 1e-9 : i % 3 == 1 ? 1 - 1e-9 : random.uniform(0, 3))*57;
        const Vec3d X = window.center + radius*at + random.uniform(-100, 100)*window.axis;
        if (X[2] < 20 || norm(Vec2d(X[0], X[1])) > 2*X[2])
            continue;
        points.push_back(X);
        expected.push_back(radius > 57 ? REFRACT_OK : REFRACT_BEHIND_WINDOW);
    }
    points.push_back(Point3d(NAN, 0, 100));
    expected.push_back(REFRACT_NOT_FINITE);
    CHECK(points.size() > 200);
    checkProjectedArrays(points, expected, window);
}

TEST_CASE("A plane, or another ray, is met where light has left a tube or dome, not on its far side", "[tube][dome][plane]")
{
    const Matx33d K(1200, 0, 639.5, 0, 1200, 511.5, 0, 0, 1);
    const double turn = 70*CV_PI/180;
    const GlassWindow tube = GlassWindow::tube(Vec3d(), Vec3d(0, std::cos(turn), std::sin(turn)), 50, 5, 1.5, 1.333);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, noArray(), tube);
    const std::vector<Point2d> pixel = { Point2d(700, 700) };
    std::vector<Point3d> points;
    std::vector<uchar> status;
    refractivePointsOnPlane(pixel, points, camera, Vec4d(0, 0, 1, 100), status);
    CHECK(status[0] == REFRACT_BEHIND_WINDOW);
    // There the line of the ray is met by that of a camera that is free.
    const Vec3d met(-14.9404, 97.7025, 100);
    std::vector<Point3d> origins, directions;
    refractiveUnprojectPoints(pixel, origins, directions, camera);
    const Vec3d onLine = Vec3d(origins[0]) + (met - Vec3d(origins[0])).dot(Vec3d(directions[0]))*Vec3d(directions[0]);
    REQUIRE(norm(onLine - met) < 1e-2);
    const Ptr<RefractiveCamera> other = RefractiveCamera::create(K, noArray());
    const Vec3d T(20, -80, 200);
    std::vector<Point2d> seen;
    refractiveProjectPoints(std::vector<Point3d>{ Point3d(onLine) }, Vec3d(), T, other, seen);
    for (int flags : { (int)TRIANGULATE_MIDPOINT, (int)TRIANGULATE_OPTIMAL })
    {
        triangulateRefractive(camera, other, Matx33d::eye(), T, pixel, seen, points, status, flags);
        CHECK(status[0] != REFRACT_OK);
        CHECK(std::isnan(points[0].x));
    }
    CAPTURE(seed());
    Random random;
    int met1 = 0, behind = 0;
    for (int i = 0; i < 4000; i++)
    {
        GlassWindow window = randomTube(random, i % 3 == 0);
        if (i % 2 == 0)
            window = GlassWindow::dome(across(window.center, window.axis), window.radius, window.thickness[0], window.index[0], 1.333);
        const Ptr<RefractiveCamera> one = RefractiveCamera::create(K, noArray(), window);
        const Vec4d plane(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), window.radius*random.logUniform(0.5, 20));
        const std::vector<Point2d> any = { Point2d(random.uniform(-2e3, 3e3), random.uniform(-2e3, 3e3)) };
        refractivePointsOnPlane(any, points, one, plane, status);
        behind += status[0] == REFRACT_BEHIND_WINDOW;
        if (status[0] != REFRACT_OK || norm(points[0]) > 1e4*window.radius)
            continue;
        std::vector<uchar> projected;
        refractiveProjectPoints(points, Vec3d(), Vec3d(), one, seen, projected);
        if (projected[0] != REFRACT_OK || window.innerIndex > 1)     // near a caustic another image may be found
            continue;
        QUICK_REQUIRE(norm(seen[0] - any[0]) < 1e-6*(1 + norm(any[0])), i, any[0], seen[0]);
        met1++;
    }
    CHECK(met1 > 1000);
    CHECK(behind > 20);
}

TEST_CASE("Every instruction set gives the same answer behind a tube", "[tube][kernels]")
{
    CAPTURE(seed());
    Random random;
    for (int i = 0; i < 20; i++)
    {
        const GlassWindow window = randomTube(random, false);
        std::vector<Vec3d> points;
        for (int k = 0; k < 301; k++)
            points.push_back(window.center + 2.5*window.radius*random.logUniform(1, 100)*unit(across(random.vector(1), window.axis))
                             + window.radius*random.uniform(-9, 9)*window.axis);
        checkInstructionSets(Seen(window).curved, points, window.radius);
    }
}

TEST_CASE("What is no tube is refused, and the text says why", "[tube]")
{
    const auto text = [](const std::function<void(GlassWindow&)>& change, int code)
    { return refusal([&] { changed(change).check(); }, code); };
    const int range = Error::StsOutOfRange, bad = Error::StsBadArg;
    CHECK_THAT(text([](GlassWindow& w) { w.center = Vec3d(0, 7, 50); }, range), Contains("the camera must be inside the tube"));
    CHECK_THAT(text([](GlassWindow& w) { w.center = 100*w.axis; }, range), Contains("no refusal"));
    CHECK_THAT(text([](GlassWindow& w) { w.radius = 0; }, range), Contains("window.radius is 0; it must be positive"));
    CHECK_THAT(text([](GlassWindow& w) { w.radius = INF; }, range), Contains("window.radius is inf"));
    CHECK_THAT(text([](GlassWindow& w) { w.center[1] = NAN; }, bad), Contains("nan"));
    CHECK_THAT(text([](GlassWindow& w) { w.axis = Vec3d(1, 1, 0); }, bad), Contains("window.axis is (1, 1, 0) with length 1.41421"));
    CHECK_THAT(text([](GlassWindow& w) { w.axis[0] = NAN; }, bad), Contains("window.axis"));
    CHECK_THAT(text([](GlassWindow& w) { w.normal = Vec3d(0, 1, 0); }, bad), Contains("window.normal is set, but the window is a tube"));
    CHECK_THAT(text([](GlassWindow& w) { w.distance = 5; }, bad), Contains("window.distance is set, but the window is a tube"));
    CHECK_THAT(text([](GlassWindow& w) { w.wedge.push_back(Vec2d()); }, bad), Contains("window.wedge is set, but the window is a tube"));
    CHECK_THAT(text([](GlassWindow& w) { w.curvature = 1; }, bad), Contains("window.curvature is set, but the window is a tube"));
    CHECK_THAT(text([](GlassWindow& w) { w.shape = WINDOW_DOME; }, bad), Contains("window.axis is set, but the window is a dome"));
    CHECK_THAT(text([](GlassWindow& w) { w.thickness[0] = -1; }, range), Contains("window.thickness[0] is -1"));
    CHECK_THAT(refusal([] { GlassWindow::tube(Vec3d(60, 9, 0), Vec3d(0, 2, 0), 50, 5, 1.5); }, range), Contains("60 from the camera"));
    CHECK_THAT(refusal([] { GlassWindow::tube(Vec3d(), Vec3d(), 50, 5, 1.5); }, bad), Contains("axisDirection is (0, 0, 0)"));
}

TEST_CASE("A tube is the same after its file", "[tube][file]")
{
    const GlassWindow tube = GlassWindow::tube(Vec3d(1.25, -2.5, 3.0625), Vec3d(0.1, 1, 0.3), 50.1, 7.3, 1.5168, 1.333);
    String text;
    const GlassWindow back = throughFile(tube, text);
    CHECK_THAT(text, Contains("shape: tube"));
    CHECK(back.shape == WINDOW_TUBE);
    CHECK(back.center == tube.center);
    CHECK(norm(back.axis - tube.axis) < 1e-15);
    CHECK(back.radius == tube.radius);
    CHECK(back.thickness == tube.thickness);
    CHECK(back.outerIndex == tube.outerIndex);
    CHECK_THAT(refusalOfFile("shape: tube, radius: 5, center: [0, 0, 1]"), Contains("glass_window.axis has 0 numbers"));
    CHECK_THAT(refusalOfFile("shape: dome, axis: [0, 0, 1], radius: 50"), Contains("glass_window has 'axis', but its shape is dome"));
    CHECK_THAT(refusalOfFile("shape: tube, normal: [0, 0, 1], radius: 50"), Contains("glass_window has 'normal', but its shape is tube"));
    CHECK_THAT(refusalOfFile("normal: [0, 0, 1], curvature: 1"), Contains("glass_window has 'curvature', but its shape is flat"));
    CHECK_THAT(refusalOfFile("normal: [0, 0, 1], outer_index: 1.333"), Contains("glass_window has no 'distance'"));
    CHECK_THAT(refusalOfFile("shape: bent, normal: [0, 0, 1], curvature: 0.001"), Contains("glass_window has no 'distance'"));
    CHECK_THAT(refusalOfFile("normal: [0, 0, 1], outer_index: 1.333, distance: 0"), !Contains("distance"));
    CHECK_THAT(refusalOfFile("normal: [0, 0, 1], outer_index: 1.333, inner_index: 1.333"), !Contains("distance"));
}

TEST_CASE("A tube's parameters are its centre, its axis and its radius", "[tube][parameters]")
{
    const GlassWindow tube = GlassWindow::tube(Vec3d(1, 2, 3), Vec3d(0, 2, 0), 50, 7, 1.5, 1.333);
    CHECK(windowParameterNames(windowLayout(tube)) == std::vector<String>{ "center[0]", "center[1]", "center[2]", "axis[0]", "axis[1]",
          "axis[2]", "radius", "thickness[0]", "index[0]", "innerIndex", "outerIndex" });
    CHECK(windowParameters(tube) == std::vector<double>{ 1, 0, 3, 0, 1, 0, 50, 7, 1.5, 1, 1.333 });
}

TEST_CASE("Two cameras may look out of one tube, or one dome", "[tube][dome]")
{
    CAPTURE(seed());
    Random random;
    for (int i = 0; i < 200; i++)
    {
        const bool isTube = i % 2 == 0;
        GlassWindow window = randomTube(random, false);
        if (!isTube)
            window = GlassWindow::dome(across(window.center, window.axis), window.radius, window.thickness[0], window.index[0]);
        Matx33d R;
        Rodrigues(random.vector(1), R);
        const Vec3d T = random.vector(0.1*window.radius);
        const GlassWindow other = windowInFrame(window, R, T);
        const Layers here(window), there(other);
        const Vec3d X = 3*window.radius*unit(random.vector(1)), Y = R*X + T;
        const Surface moved = inFrame(there.lastSurface(), R.val, T.val);
        CHECK(moved.distance == Approx(here.lastSurface().distance).epsilon(1e-12));
        CHECK(norm(Vec3d(moved.normal) - Vec3d(here.lastSurface().normal)) < 1e-12);
        CHECK(here.isBeyond(X[0], X[1], X[2]) == there.isBeyond(Y[0], Y[1], Y[2]));
    }
}
