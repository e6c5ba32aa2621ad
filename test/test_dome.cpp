// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Domes; against 60-digit references in test_reference.cpp, in every call as two of allWindows().
#include "curved_scenes.hpp"
#include "quick_require.hpp"
#include "window/dome.hpp"
#include "window/dome_kernels.hpp"
#include "window/parameters.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

const Matx33d K = CURVED_K;

/** One to three layers; the centre up to 0.6 radii off.
@param anyMedia round the camera, too, and the centre up to 0.95 radii off: there may be total reflection and caustics */
GlassWindow randomDome(Random& random, bool anyMedia)
{
    const double radius = random.logUniform(5, 500);
    const Vec3d towards = random.vector(1);
    const double media[] = { 1, 1.333, 1.5 };
    GlassWindow window = GlassWindow::dome(random.uniform(0, anyMedia ? 0.95 : 0.6)*radius/norm(towards)*towards, radius,
                                           radius*random.uniform(0.01, 0.5), random.uniform(1.45, 1.8), media[random.below(2)]);
    for (int layer = random.below(3); layer > 0; layer--)
    {
        window.thickness.push_back(radius*random.uniform(0.01, 0.2));
        window.index.push_back(random.uniform(1.3, 1.7));
    }
    if (anyMedia)
        window.innerIndex = media[random.below(3)];
    return window;
}

//! Vector Snell, sphere by sphere. @return false: total reflection
bool trace(const GlassWindow& w, Vec3d& point, Vec3d& direction, double* leastCosine = nullptr)
{
    double medium = w.innerIndex, radius = w.radius;
    point = Vec3d();
    for (size_t k = 0; k <= w.index.size(); k++)
    {
        const double next = k < w.index.size() ? w.index[k] : w.outerIndex;
        const Vec3d off = point - w.center;
        const double ahead = off.dot(direction);
        point += (-ahead + std::sqrt(ahead*ahead - off.dot(off) + radius*radius))*direction;
        if (!refractAt(direction, (point - w.center)/radius, medium, next, leastCosine))
            return false;
        medium = next;
        radius += k < w.index.size() ? w.thickness[k] : 0;
    }
    return true;
}

Dome domeOf(const GlassWindow& window, const std::vector<Sphere>& faces)
{
    const WindowLayout at = windowLayout(window);
    return { { window.center[0], window.center[1], window.center[2] }, 0, faces.data(), (int)faces.size(), window.innerIndex,
             window.outerIndex, at };
}

GlassWindow changed(const std::function<void(GlassWindow&)>& change)
{
    GlassWindow window = GlassWindow::dome(Vec3d(1, 2, 3), 50, 5, 1.5);
    change(window);
    return window;
}

} // namespace

TEST_CASE("Round trips through domes, to all sides, of any media", "[dome]")
{
    CAPTURE(seed());
    Random random;
    double worst = 0;
    int trips = 0, reflected = 0, several = 0, left = 0;
    for (int i = 0; i < 40000; i++)
    {
        const GlassWindow window = randomDome(random, i % 2 == 1);
        const Layers layers(window);
        const Vec3d w = unit(random.vector(1));
        Vec3d point, direction = w, back;
        double grazing = 1;
        const bool gets = trace(window, point, direction, &grazing);
        Rays rays;
        uchar status = REFRACT_OK;
        layers.traceOut(1, &w[0], &w[1], &w[2], rays, &status);
        QUICK_REQUIRE(status == (gets ? REFRACT_OK : REFRACT_TOTAL_REFLECTION), i, w, grazing);
        reflected += !gets;
        if (!gets || grazing < 1e-2)
            continue;
        const double size = window.radius;
        QUICK_REQUIRE(norm(rays.direction(0) - direction) < 1e-14/grazing, i, w);
        const Vec3d off = (rays.origin(0, layers.normal()) - point).cross(direction);
        QUICK_REQUIRE(norm(off) < 1e-13*(size + std::abs(rays.tau[0]))/grazing, i, w);
        const double mu = layers.leavingMu(rays, 0);
        QUICK_REQUIRE(norm(rays.origin(0, layers.normal()) + rays.direction(0)/mu - point) < 1e-12*(size + std::abs(rays.tau[0]))/grazing,
                      i, w);
        const Vec3d X = point + size*random.logUniform(1e-2, 1e4)*direction;
        QUICK_REQUIRE(layers.isBeyond(X[0], X[1], X[2]), i, w);
        QUICK_REQUIRE(!layers.isBeyond(0.999*point[0], 0.999*point[1], 0.999*point[2]), i, w);
        const std::vector<Sphere> faces = spheresOf(window);
        const Dome dome = domeOf(window, faces);
        double none;
        left += !domeKernels().solveIn(dome, 1, &X[0], &X[1], &X[2], NULL, &back[0], &back[1], &none);
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
        Vec3d scalar;
        QUICK_REQUIRE(findDomePath(dome, X, 1, scalar) == REFRACT_OK, i, w, X);
        QUICK_REQUIRE((!isRarest || norm(unit(scalar) - w)*grazing*grazing < 1e-13), i, w, X);
        QUICK_REQUIRE(solveIn(layers, X*1e-4, 1e-4, back) == REFRACT_OK, i, w, X);
        QUICK_REQUIRE((!isRarest || norm(unit(back) - w)*grazing*grazing < 1e-13), i, w, X);
        QUICK_REQUIRE(solveIn(layers, direction, 0, back) == REFRACT_OK, i, w);
        QUICK_REQUIRE((!isRarest || norm(unit(back) - w)*grazing*grazing < 1e-13), i, w);
        trips++;
    }
    CHECK(trips > 30000);
    CHECK(reflected > 100);
    CHECK(left < trips/100);
    printNumber("round trips through domes", trips, "");
    printNumber("round trips through domes, worst angle * cos(grazing angle)^2", worst, "rad");
    printNumber("points that the kernel leaves to scalar code", left, "");
    printNumber("points with another image than the one they were made from", several, "");
}

TEST_CASE("A dome with its centre at the camera does not refract", "[dome]")
{
    CAPTURE(seed());
    Random random;
    const Ptr<RefractiveCamera> dome = RefractiveCamera::create(K, noArray(), GlassWindow::dome(Vec3d(), 50, 6, 1.52, 1.333));
    const Ptr<RefractiveCamera> none = RefractiveCamera::create(K, noArray());
    std::vector<Point3d> points;
    for (int i = 0; i < 500; i++)
        points.push_back(Point3d(random.uniform(-300, 300), random.uniform(-300, 300), random.uniform(100, 1e4)));
    std::vector<Point2d> behind, plain;
    std::vector<Point3d> origins, directions;
    Mat J;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), dome, behind, noArray(), J);
    refractiveProjectPoints(points, Vec3d(), Vec3d(), none, plain);
    refractiveUnprojectPoints(behind, origins, directions, dome);
    for (size_t i = 0; i < points.size(); i++)
    {
        REQUIRE(norm(behind[i] - plain[i]) < 1e-11);
        REQUIRE(norm(origins[i]) == 0);
        REQUIRE(norm(directions[i].cross(points[i])) < 1e-14*norm(points[i]));
    }
    // Radius, thickness and indices have no effect, as said; the centre has.
    for (int row = 0; row < J.rows; row++)
        for (int c = 6 + 4 + 3; c < J.cols; c++)
            REQUIRE(std::abs(J.at<double>(row, c)) < 1e-10);
    CHECK(norm(J.col(6 + 4)) > 1);
}

TEST_CASE("A dome becomes a flat window as its radius grows", "[dome]")
{
    CAPTURE(seed());
    checkLimitOfRadius("dome", [](const GlassWindow& flat, double radius)
    { return GlassWindow::dome(-(radius - flat.distance)*flat.normal, radius, flat.thickness[0], flat.index[0], flat.outerIndex); });
}

TEST_CASE("Points before and inside a dome are behind the window", "[dome]")
{
    CAPTURE(seed());
    Random random;
    const GlassWindow window = GlassWindow::dome(Vec3d(5, -4, 12), 50, 7, 1.5, 1.333);
    std::vector<Point3d> points;
    std::vector<uchar> expected;
    for (int i = 0; i < 1000; i++)
    {
        const Vec3d at = unit(random.vector(1));
        const double radius = (i % 3 == 0 ? 1 + 1e-9 : i % 3 == 1 ? 1 - 1e-9 : random.uniform(0, 3))*57;
        const Vec3d X = window.center + radius*at;
        if (X[2] < 5)
            continue;
        points.push_back(X);
        expected.push_back(radius > 57 ? REFRACT_OK : REFRACT_BEHIND_WINDOW);
    }
    points.push_back(Point3d(NAN, 0, 100));
    expected.push_back(REFRACT_NOT_FINITE);
    checkProjectedArrays(points, expected, window);
}

TEST_CASE("Every instruction set gives the same answer behind a dome", "[dome][kernels]")
{
    CAPTURE(seed());
    Random random;
    const int n = 301;
    for (int i = 0; i < 20; i++)
    {
        const GlassWindow window = randomDome(random, false);
        const std::vector<Sphere> faces = spheresOf(window);
        const Dome dome = domeOf(window, faces);
        std::vector<double> x(n), y(n), z(n), d[3], expected[3];
        for (int k = 0; k < n; k++)
        {
            const Vec3d X = window.center + 2.5*window.radius*random.logUniform(1, 100)*unit(random.vector(1));
            x[k] = X[0]; y[k] = X[1]; z[k] = X[2];
        }
        for (const Kernels* level : kernelLevels())
        {
            for (std::vector<double>& values : d)
                values.assign(n, 0);
            CHECK(level->dome.solveIn(dome, n, x.data(), y.data(), z.data(), NULL, d[0].data(), d[1].data(), d[2].data()));
            if (expected[0].empty())
                std::copy(d, d + 3, expected);
            for (int k = 0; k < n; k++)
            {
                const Vec3d one = unit(Vec3d(d[0][k], d[1][k], d[2][k])), other(expected[0][k], expected[1][k], expected[2][k]);
                REQUIRE(norm(one - unit(other)) < 1e-14);
            }
        }
    }
}

TEST_CASE("What is no dome is refused, and the text says why", "[dome]")
{
    const auto text = [](const std::function<void(GlassWindow&)>& change, int code)
    { return refusal([&] { changed(change).check(); }, code); };
    const int range = Error::StsOutOfRange, bad = Error::StsBadArg;
    CHECK_THAT(text([](GlassWindow& w) { w.center = Vec3d(0, 0, 50); }, range), Contains("the camera must be inside the dome"));
    CHECK_THAT(text([](GlassWindow& w) { w.radius = 0; }, range), Contains("window.radius is 0; it must be positive"));
    CHECK_THAT(text([](GlassWindow& w) { w.radius = INF; }, range), Contains("window.radius is inf"));
    CHECK_THAT(text([](GlassWindow& w) { w.radius = NAN; }, range), Contains("window.radius is nan"));
    CHECK_THAT(text([](GlassWindow& w) { w.center[1] = NAN; }, bad), Contains("window.center is (1, nan, 3); it must be finite"));
    CHECK_THAT(text([](GlassWindow& w) { w.normal = Vec3d(0, 1, 0); }, bad), Contains("window.normal is set, but the window is a dome"));
    CHECK_THAT(text([](GlassWindow& w) { w.distance = 5; }, bad), Contains("window.distance is set, but the window is a dome"));
    CHECK_THAT(text([](GlassWindow& w) { w.wedge.push_back(Vec2d()); }, bad), Contains("window.wedge is set, but the window is a dome"));
    CHECK_THAT(text([](GlassWindow& w) { w.shape = 7; }, range), Contains("window.shape is 7"));
    CHECK_THAT(text([](GlassWindow& w) { w.shape = WINDOW_FLAT; }, bad), Contains("window.center is set, but the window is flat"));
    CHECK_THAT(text([](GlassWindow& w) { w.thickness[0] = -1; }, range), Contains("window.thickness[0] is -1"));
    CHECK_THAT(text([](GlassWindow& w) { w.outerIndex = 0.9; }, range), Contains("window.outerIndex is 0.9"));
    CHECK_THAT(refusal([] { GlassWindow::dome(Vec3d(60, 0, 0), 50, 5, 1.5); }, range), Contains("60 from the camera"));
}

TEST_CASE("A dome is the same after its file, and a flat window's file has no word of it", "[dome][file]")
{
    GlassWindow dome = GlassWindow::dome(Vec3d(1.25, -2.5, 3.0625), 50.1, 7.3, 1.5168, 1.333);
    String text;
    const GlassWindow back = throughFile(dome, text);
    CHECK_THAT(text, Contains("shape: dome"));
    String ofFlat;
    throughFile(GlassWindow(Vec3d(0, 0, 1), 5, 1.5), ofFlat);
    CHECK(ofFlat.find("radius") == String::npos);
    CHECK(ofFlat.find("shape") == String::npos);
    CHECK(back.shape == WINDOW_DOME);
    CHECK(back.center == dome.center);
    CHECK(back.radius == dome.radius);
    CHECK(back.thickness == dome.thickness);
    CHECK(back.index == dome.index);
    CHECK(back.outerIndex == dome.outerIndex);
    CHECK_THAT(refusalOfFile("shape: cone, radius: 5"), Contains("glass_window.shape is 'cone'; it must be flat, dome, tube or bent"));
    CHECK_THAT(refusalOfFile("radius: 50, center: [0, 0, 1], thickness: 5, index: 1.5"), Contains("its shape is flat"));
    CHECK_THAT(refusalOfFile("shape: dome, normal: [0, 0, 1], radius: 50"), Contains("glass_window has 'normal', but its shape is dome"));
    CHECK_THAT(refusalOfFile("shape: dome, center: [0, 0], radius: 50"), Contains("glass_window.center has 2 numbers"));
}

TEST_CASE("A dome's parameters are its centre and its radius", "[dome][parameters]")
{
    const GlassWindow dome = GlassWindow::dome(Vec3d(1, 2, 3), 50, 7, 1.5, 1.333);
    const std::vector<String> names = windowParameterNames(windowLayout(dome));
    CHECK(names == std::vector<String>{ "center[0]", "center[1]", "center[2]", "radius", "thickness[0]", "index[0]", "innerIndex",
                                        "outerIndex" });
    std::vector<double> p = windowParameters(dome);
    CHECK(p == std::vector<double>{ 1, 2, 3, 50, 7, 1.5, 1, 1.333 });
    p[2] = 4;
    p[3] = 60;
    const GlassWindow moved = withParameters(dome, p.data());
    CHECK(moved.center == Vec3d(1, 2, 4));
    CHECK(moved.radius == 60);
    CHECK(moved.normal == Vec3d(0, 0, 1));
    CHECK(kindOf(windowLayout(dome), 2) == WindowParameter::CENTER);
    CHECK(kindOf(windowLayout(dome), 3) == WindowParameter::RADIUS);
}
