// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/wedge.hpp"
#include "paper_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

TEST_CASE("Traced with parallel faces, the rays are the library's", "[wedge]")
{
    scenes::Random random(3003);
    std::cout << "seed " << scenes::seed() << '\n';
    for (int kind = 1; kind < scenes::WINDOW_KINDS; kind++)
    {
        const Ptr<RefractiveCamera> camera = copyWithWindow(paperRig(1).cameras[0],
                                                            scenes::makeWindow((scenes::WindowKind)kind, random));
        const std::vector<Point2d> pixels = {{10, 10}, {640, 500}, {1270, 1000}};
        std::vector<Point3d> points;
        refractivePointsOnPlane(pixels, points, camera, Vec4d(0, 0, 1, 700));
        const std::vector<Point3d> traced = traceWedge(camera, pixels, Wedge(), std::vector<double>(3, 700.));
        CAPTURE(scenes::name((scenes::WindowKind)kind));
        for (int i = 0; i < 3; i++)
            CHECK((norm(traced[i] - points[i]) < 1e-8 || points[i] != points[i]));
    }
}

TEST_CASE("A thin wedge turns the ray by (index - 1) times its angle", "[wedge]")
{
    const Ptr<RefractiveCamera> camera = copyWithWindow(paperRig(1).cameras[0], GlassWindow(Vec3d(0, 0, 1), 1e-6, 1.5, 0.));
    const std::vector<Point2d> centre = {{paper::K1(0, 2), paper::K1(1, 2)}};
    const double angle = 1e-5;
    const Point3d at = traceWedge(camera, centre, {Vec3d(angle, 0, 0), 0.}, {1000.})[0];
    CHECK(at.x == Approx(-0.5*angle*1000.).epsilon(1e-3));        // towards the base: the thick side is where x < 0
    CHECK(std::abs(at.y) < 1e-9);
}

TEST_CASE("The shift of an image by a wedge is right to first order", "[wedge]")
{
    const Ptr<RefractiveCamera> camera = paperRig(1).cameras[0];
    const std::vector<Point3d> points = {{0, 0, 600}, {100, -80, 650}, {-90, 60, 560}};
    const Vec3d across = normalize(camera->window().normal.cross(Vec3d(0, 1, 0)));
    std::vector<Point2d> pixels;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels);
    double last = 0.;
    for (double angle : {1e-3, 1e-4})
    {
        const Wedge wedge{angle*across, 0.};
        std::vector<Point2d> shifted = wedgeShift(camera, points, wedge);
        double miss = 0.;
        for (size_t i = 0; i < points.size(); i++)
            shifted[i] += pixels[i];
        const std::vector<Point3d> traced = traceWedge(camera, shifted, wedge, {600., 650., 560.});
        for (size_t i = 0; i < points.size(); i++)
        {
            CHECK(norm(shifted[i] - pixels[i]) > 500.*angle);
            miss = std::max(miss, norm(traced[i] - points[i]));
        }
        if (last > 0.)
            CHECK(miss < 0.02*last);      // second order: a hundredth
        last = miss;
    }
}
