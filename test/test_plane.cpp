// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refractivePointsOnPlane: the paper's two-dimensional measurement.
#include "scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

TEST_CASE("Points of a plane are found again", "[plane]")
{
    const WindowKind kind = GENERATE(from_range(allWindows()));
    CAPTURE(name(kind), seed());
    Random random(kind);
    double worst = 0;
    for (const LensKind& lens : allLenses())
    {
        CAPTURE(lens.name);
        const Ptr<RefractiveCamera> camera = makeCamera(lens, makeWindow(kind, random, 15));
        const Vec3d n = randomNormal(random, 40)*random.uniform(0.1, 10);
        const double d = n.dot(Vec3d(0, 0, random.uniform(500, 1500)));
        std::vector<Vec3d> points, found;
        for (int i = 0; i < 300; i++)
        {
            const Vec3d w = randomNormal(random, std::min(35., 0.9*lens.halfField));
            points.push_back(d/n.dot(w)*w);
        }
        std::vector<Vec2d> pixels;
        std::vector<uchar> seen, status;
        refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels, seen);
        refractivePointsOnPlane(pixels, found, camera, Vec4d(n[0], n[1], n[2], d), status);
        int count = 0;
        for (size_t i = 0; i < points.size(); i++)
        {
            if (seen[i] != REFRACT_OK)
                continue;
            count++;
            REQUIRE(status[i] == REFRACT_OK);
            const double error = norm(found[i] - points[i])/norm(points[i]);
            worst = std::max(worst, error);
            REQUIRE(error < 1e-11);
            REQUIRE(std::abs(n.dot(found[i]) - d) < 1e-13*norm(n)*norm(found[i]));
        }
        CHECK(count > 200);
    }
    printNumber(std::string("points on a plane, ") + name(kind) + ", worst share of the range", worst, "");
}

TEST_CASE("Only the plane counts, not how it is written; both overloads agree", "[plane]")
{
    const std::vector<Vec2d> pixels = { { 100, 100 }, { 640, 480 }, { 1200, 900 } };
    std::vector<Vec3d> a, b, c;
    refractivePointsOnPlane(pixels, a, PLAIN_K, noArray(), paper::pane(), Vec4d(0.1, 0.2, 1, 700));
    refractivePointsOnPlane(pixels, b, PLAIN_K, noArray(), paper::pane(), Vec4d(-0.1, -0.2, -1, -700)*1e-3);
    refractivePointsOnPlane(pixels, c, RefractiveCamera::create(PLAIN_K, noArray(), paper::pane()), Vec4d(0.1, 0.2, 1, 700));
    CHECK(largestDifference(a, b) < 1e-10);
    CHECK(largestDifference(a, c) == 0);
}

TEST_CASE("A plane of any numbers is met, as far away as there are numbers", "[plane]")
{
    const std::vector<Vec2d> pixels = { { 100, 100 }, { 640, 480 }, { 1200, 900 } };
    std::vector<Vec3d> expected, found;
    std::vector<uchar> status;
    const Vec4d plane(0.1, 0.2, 1, 700);
    refractivePointsOnPlane(pixels, expected, PLAIN_K, noArray(), paper::pane(), plane);
    for (int exponent : { -1000, -700, -520, 520, 700, 1000 })
    {
        CAPTURE(exponent);
        refractivePointsOnPlane(pixels, found, PLAIN_K, noArray(), paper::pane(), plane*std::ldexp(1., exponent), status);
        CHECK(status == std::vector<uchar>(3, REFRACT_OK));
        CHECK(largestDifference(found, expected) < 1e-10);
    }
    // z is within the numbers, the point's distance is not.
    refractivePointsOnPlane(std::vector<Vec2d>{ { 640, 480 }, { 640 + 3000, 480 } }, found, PLAIN_K, noArray(), paper::pane(),
                            Vec4d(0, 0, 1, 1.7e308), status);
    CHECK(status[0] == REFRACT_OK);
    CHECK(found[0][2]/1.7e308 == Approx(1));
    CHECK(status[1] == REFRACT_PARALLEL_RAYS);
    CHECK(std::isnan(found[1][0]));
}

TEST_CASE("Pixels that do not meet the plane say why", "[plane]")
{
    const std::vector<Vec2d> pixels = { { 640, 480 }, { NaN, 480 } };
    std::vector<Vec3d> out;
    std::vector<uchar> status;
    const auto meet = [&](const GlassWindow& window, const Vec4d& plane)
    {
        refractivePointsOnPlane(pixels, out, PLAIN_K, noArray(), window, plane, status);
        CHECK(status[1] == REFRACT_NOT_FINITE);
        CHECK(std::isfinite(out[0][0]) == (status[0] == REFRACT_OK));
        CHECK(std::isfinite(out[0][2]) == (status[0] == REFRACT_OK));
        CHECK(std::isnan(out[1][1]));
        return (int)status[0];
    };
    const GlassWindow straight(Vec3d(0, 0, 1), 20, 1.5, 50);
    CHECK(meet(straight, Vec4d(0, 0, 1, 500)) == REFRACT_OK);
    CHECK(out[0] == Vec3d(0, 0, 500));
    CHECK(meet(straight, Vec4d(0, 1, 0, 500)) == REFRACT_PARALLEL_RAYS);
    CHECK(meet(straight, Vec4d(0, 1, 0, 0)) == REFRACT_PARALLEL_RAYS);       // the ray lies in the plane
    CHECK(meet(straight, Vec4d(0, 0, 1, -500)) == REFRACT_NO_INTERSECTION);
    CHECK(meet(straight, Vec4d(0, 0, 1, 60)) == REFRACT_BEHIND_WINDOW);      // within the glass
    CHECK(meet(straight, Vec4d(0, 0, 1, 30)) == REFRACT_BEHIND_WINDOW);      // before it
    CHECK(meet(straight, Vec4d(0, 0, 1, 70.001)) == REFRACT_OK);
    CHECK(meet(GlassWindow(), Vec4d(0, 0, 1, 30)) == REFRACT_OK);
    CHECK(meet(GlassWindow(), Vec4d(0, 0, 1, 0)) == REFRACT_NO_INTERSECTION);
    // A plane beside the axis that the tilted window's ray still meets, far away.
    CHECK(meet(paper::pane(), Vec4d(1, 0, 1e-9, 500)) == REFRACT_OK);
}

TEST_CASE("A plane that is none is refused with its numbers", "[plane]")
{
    std::vector<Vec3d> out;
    const auto meet = [&](const Vec4d& plane)
    {
        return thrown([&] { refractivePointsOnPlane(std::vector<Vec2d>(1), out, PLAIN_K, noArray(), paper::pane(), plane); });
    };
    CHECK_THAT(meet(Vec4d(0, 0, 0, 5)), Contains("plane") && Contains("(0, 0, 0, 5)"));
    CHECK_THAT(meet(Vec4d(0, NaN, 1, 5)), Contains("plane") && Contains("nan"));
    CHECK_THAT(meet(Vec4d(0, 0, 1, INF)), Contains("plane") && Contains("inf"));
    CHECK_THAT(meet(Vec4d(INF, 0, 1, 1)), Contains("plane") && Contains("inf"));
}
