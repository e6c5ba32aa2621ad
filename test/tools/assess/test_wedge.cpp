// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/wedge.hpp"
#include "paper_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

TEST_CASE("A thin wedge turns the ray by (index - 1) times its angle", "[wedge]")
{
    const double angle = 1e-5;
    const GlassWindow window = withWedge(GlassWindow(Vec3d(0, 0, 1), 1e-6, 1.5, 0.), {Vec3d(angle, 0, 0), 0.});
    std::vector<Point3d> at;
    refractivePointsOnPlane(std::vector<Point2d>{{paper::K1(0, 2), paper::K1(1, 2)}}, at,
                            copyWithWindow(paperRig(1).cameras[0], window), Vec4d(0, 0, 1, 1000));
    CHECK(at[0].x == Approx(-0.5*angle*1000.).epsilon(1e-3));       // towards the base: the thick side is where x < 0
    CHECK(std::abs(at[0].y) < 1e-9);
}

TEST_CASE("A wedge is beside the one that the window is known to have", "[wedge]")
{
    GlassWindow window(Vec3d(0.2, -0.1, 1), 20, 1.5, 50);
    window.thickness.push_back(3);
    window.index.push_back(1.4);
    const Vec3d across = normalize(window.normal.cross(Vec3d(0, 1, 0)));
    const GlassWindow once = withWedge(window, {1e-3*across, 0.1}), twice = withWedge(once, {1e-3*across, 0.1});
    CHECK(once.wedge[0] == Vec2d());
    CHECK(norm(once.wedge[1]) == Approx(1e-3));
    CHECK(norm(twice.wedge[1] - 2*once.wedge[1]) < 1e-18);
    CHECK(twice.thickness[1] == Approx(3.2));
}

TEST_CASE("The shift of an image by a wedge grows with it", "[wedge]")
{
    const Ptr<RefractiveCamera> camera = paperRig(1).cameras[0];
    const std::vector<Point3d> points = {{0, 0, 600}, {100, -80, 650}, {-90, 60, 560}};
    const Vec3d across = normalize(camera->window().normal.cross(Vec3d(0, 1, 0)));
    const std::vector<Point2d> small = wedgeShift(camera, points, {1e-4*across, 0.}), large = wedgeShift(camera, points, {2e-4*across, 0.});
    for (size_t i = 0; i < points.size(); i++)
    {
        CHECK(norm(small[i]) > 500.*1e-4);
        CHECK(norm(large[i] - 2.*small[i]) < 2e-3*norm(small[i]));
    }
}
