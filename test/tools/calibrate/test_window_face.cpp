// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Where rays meet a window's faces: as the module's own rays do, and as the shapes' equations say.
#include "calibrate/window_face.hpp"
#include "scenes.hpp"
#include <catch2/catch.hpp>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

Ptr<RefractiveCamera> cameraBehind(const GlassWindow& window)
{
    return RefractiveCamera::create(Matx33d(900, 0, 500, 0, 900, 400, 0, 0, 1), Mat(), window);
}

} // namespace

TEST_CASE("A ray leaves the last face where the module lets it leave", "[window_face]")
{
    scenes::Random random(4101);
    std::cout << "seed " << scenes::seed() << '\n';
    GlassWindow wedged(normalize(Vec3d(0.2, -0.1, 1)), 20, 1.52, 40, 1.333);
    wedged.wedge = {Vec2d(0.01, -0.02)};
    const std::vector<GlassWindow> windows = {GlassWindow(normalize(Vec3d(-0.2, 0.1, 1)), 20, 1.52, 40), wedged,
                                              GlassWindow::dome(Vec3d(5, -3, 9), 50, 6, 1.49, 1.333)};
    for (const GlassWindow& window : windows)
    {
        const WindowFace last = WindowFace::last(window);
        const Ptr<RefractiveCamera> camera = cameraBehind(window);
        for (int i = 0; i < 20; i++)
        {
            const std::vector<Point2d> pixel = {{random.uniform(0, 1000), random.uniform(0, 800)}};
            std::vector<Vec3d> origins, directions;
            refractiveUnprojectPoints(pixel, origins, directions, camera);
            const Vec3d leaves = last.meets(origins[0], directions[0]);
            CHECK(last.isBefore(leaves - 1e-6*directions[0]));
            CHECK(!last.isBefore(leaves + 1e-6*directions[0]));
            // The module refuses points within the window, and sees those just beyond it.
            std::vector<Point2d> seen;
            std::vector<uchar> status;
            refractiveProjectPoints(std::vector<Vec3d>{leaves + 1e-3*directions[0], leaves - 1e-1*directions[0]}, Vec3d(), Vec3d(), camera,
                                    seen, status);
            CHECK(norm(seen[0] - pixel[0]) < 1e-6);
            CHECK(status[0] == REFRACT_OK);
            CHECK(status[1] != REFRACT_OK);
        }
    }
}

TEST_CASE("Faces are what their shapes' equations say", "[window_face]")
{
    scenes::Random random(4102);
    std::cout << "seed " << scenes::seed() << '\n';
    const GlassWindow dome = GlassWindow::dome(Vec3d(5, -3, 9), 50, 6, 1.49);
    GlassWindow tube = dome, bent(normalize(Vec3d(0.1, 0.2, 1)), 8, 1.52, 30);
    tube.shape = WINDOW_TUBE;
    tube.axis = normalize(Vec3d(0.1, 1, -0.2));
    bent.shape = WINDOW_BENT;
    for (int i = 0; i < 20; i++)
    {
        const Vec3d along = normalize(Vec3d(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), 1));
        CHECK(norm(WindowFace::first(dome).meets(Vec3d(), along) - dome.center) == Approx(50.));
        CHECK(norm(WindowFace::last(dome).meets(Vec3d(), along) - dome.center) == Approx(56.));
        const Vec3d fromAxis = WindowFace::last(tube).meets(Vec3d(), along) - tube.center;
        CHECK(norm(fromAxis - tube.axis.dot(fromAxis)*tube.axis) == Approx(56.));
        for (double curvature : {1./400, -1./400})
        {
            bent.curvature = curvature;
            const Vec3d centre = (bent.distance - 1./curvature)*bent.normal;
            CHECK(norm(WindowFace::first(bent).meets(Vec3d(), along) - centre) == Approx(std::abs(1./curvature)));
            CHECK(norm(WindowFace::last(bent).meets(Vec3d(), along) - centre) == Approx(std::abs(1./curvature + 8.)));
        }
        bent.curvature = 1e-14;
        GlassWindow flat = bent;
        flat.shape = WINDOW_FLAT;
        CHECK(norm(WindowFace::last(bent).meets(Vec3d(), along) - WindowFace::last(flat).meets(Vec3d(), along)) < 1e-9);
    }
    CHECK(WindowFace::last(GlassWindow()).along(Vec3d(), Vec3d(0, 0, 1)) == -std::numeric_limits<double>::infinity());
    CHECK(!WindowFace::last(GlassWindow()).isBefore(Vec3d(0, 0, -1)));
}

TEST_CASE("A camera's place in a window is told by its offset", "[window_face]")
{
    const GlassWindow dome = GlassWindow::dome(Vec3d(3, 4, 12), 50, 6, 1.49);
    CHECK(offsetOf(dome) == Approx(13.));
    GlassWindow tube = dome, moved = dome;
    tube.shape = WINDOW_TUBE;
    tube.axis = Vec3d(0, 0, 1);
    CHECK(offsetOf(tube) == Approx(5.));
    moved.center += Vec3d(0.3, 0, 0.4);
    CHECK(placeChange(dome, moved) == Approx(0.5));
    CHECK(placeUnit(dome, "mm") == "mm");
    const GlassWindow flat(Vec3d(0, 0, 1), 5, 1.5), tilted(Vec3d(0, std::sin(0.01), std::cos(0.01)), 5, 1.5);
    CHECK(placeChange(flat, tilted) == Approx(0.01*180/CV_PI));
    CHECK(placeUnit(flat, "mm") == "deg");
}
