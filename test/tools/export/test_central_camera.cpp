// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The central camera nearest to one behind a window, against calib3d's own projection.
#include "export/central_camera.hpp"
#include <catch2/catch.hpp>
#include <opencv2/calib3d.hpp>
#include <cmath>
#include <iostream>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

Ptr<RefractiveCamera> cameraBehind(const GlassWindow& window, bool isFisheye = false)
{
    const Matx33d K(900, 0, 322, 0, 905, 236, 0, 0, 1), wide(250, 0, 322, 0, 250, 236, 0, 0, 1);
    const Ptr<RefractiveCamera> camera =
        isFisheye ? RefractiveCamera::createFisheye(wide, Vec4d(0.02, -0.003, 0.001, 0), window)
                  : RefractiveCamera::create(K, Vec<double, 5>(-0.2, 0.1, 0.0004, -0.0003, 0.02), window);
    camera->setImageSize(Size(640, 480));
    return camera;
}

//! What cv::projectPoints (cv::fisheye::projectPoints) makes of points of the range is off by what was stated.
void checkError(const Ptr<RefractiveCamera>& camera, const Vec2d& range, int coefficients)
{
    const CentralCamera central = fitCentralCamera(camera, range, coefficients, "camera1");
    RNG rng(7);
    std::vector<Point3d> points;
    std::vector<Point2d> pixels;
    for (int i = 0; i < 3000; i++)
    {
        const double u = rng.uniform(0., 639.), v = rng.uniform(0., 479.);      // one by one: compilers differ in the order
        const std::vector<Point2d> pixel = { Point2d(u, v) };
        std::vector<Point3d> X;
        refractivePointsOnPlane(pixel, X, camera, Vec4d(0, 0, 1, 1/rng.uniform(1/range[1], 1/range[0])));
        if (X[0].z != X[0].z)
            continue;       // totally reflected
        points.push_back(X[0]);
        pixels.push_back(pixel[0]);
    }
    Vec3d rvec;
    Rodrigues(central.pose.R, rvec);
    std::vector<Point2d> seen;
    if (coefficients == 0)
        fisheye::projectPoints(points, seen, rvec, central.pose.t, central.camera->cameraMatrix(), central.camera->distCoeffs());
    else
        projectPoints(points, rvec, central.pose.t, central.camera->cameraMatrix(), central.camera->distCoeffs(), seen);
    double rms = 0, most = 0;
    for (size_t i = 0; i < seen.size(); i++)
    {
        const double px = norm(seen[i] - pixels[i]);
        rms += px*px/(double)seen.size();
        most = std::max(most, px);
    }
    rms = std::sqrt(rms);
    CAPTURE(rms, most, central.error.rms, central.error.max);
    // The grid of what is stated has the image's border in it, where the error is largest; these points hardly ever.
    CHECK(rms <= 1.05*central.error.rms + 1e-7);
    CHECK(rms >= 0.7*central.error.rms - 1e-7);
    CHECK(most <= 1.05*central.error.max + 1e-7);
    CHECK(most >= 0.3*central.error.max - 1e-7);
}

} // namespace

TEST_CASE("Without a window the central camera is the camera itself", "[tools][export]")
{
    const CentralCamera central = fitCentralCamera(cameraBehind(GlassWindow()), Vec2d(400, 1200), 5, "camera1");
    CHECK(central.error.max < 1e-6);
    CHECK(norm(central.pose.t) < 1e-6);
    CHECK(norm(central.pose.R - Matx33d::eye()) < 1e-9);
    CHECK(norm(central.camera->lensParameters(), cameraBehind(GlassWindow())->lensParameters(), NORM_INF) < 1e-5);
    const CentralCamera wide = fitCentralCamera(cameraBehind(GlassWindow(), true), Vec2d(400, 1200), 0, "camera1");
    CHECK(wide.error.max < 1e-6);
}

TEST_CASE("A central camera is off by what is stated, in air and in water", "[tools][export]")
{
    const GlassWindow pane(Vec3d(0.2, -0.1, 0.97), 25, 1.5, 60), port(Vec3d(0.02, -0.01, 1), 10, 1.5, 30, 1.333);
    checkError(cameraBehind(pane), Vec2d(400, 1200), 8);
    checkError(cameraBehind(pane), Vec2d(400, 1200), 12);
    checkError(cameraBehind(port), Vec2d(400, 3000), 8);
    checkError(cameraBehind(port), Vec2d(400, 3000), 4);
    checkError(cameraBehind(pane, true), Vec2d(400, 1200), 0);
}

TEST_CASE("A pane straight before the camera moves it along the axis, by what Snell's law says", "[tools][export]")
{
    // Far off and near the axis a pane of thickness t seems to bring the scene nearer by t (1 - 1/n).
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(9000, 0, 319.5, 0, 9000, 239.5, 0, 0, 1), noArray(),
                                                                  GlassWindow(Vec3d(0, 0, 1), 30, 1.5, 60));
    camera->setImageSize(Size(640, 480));
    const CentralCamera central = fitCentralCamera(camera, Vec2d(300, 900), 4, "camera1");
    CHECK(central.pose.t[2] == Approx(-10).margin(0.02));
    CHECK(std::hypot(central.pose.t[0], central.pose.t[1]) < 1e-3);
    CHECK(central.error.max < 0.01);
}

TEST_CASE("A lens without a fisheye's angles is no central camera of one that has them", "[tools][export]")
{
    // What a fit is that has diverged: a fisheye of over 180 degrees in a dome, as a polynomial of a plane.
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createFisheye(Matx33d(242, 0, 318, 0, 241, 325, 0, 0, 1),
        Vec4d(0.02, -0.01, 0.002, 0), GlassWindow::dome(Vec3d(-3, 2, 4), 60, 6, 1.49, 1.333));
    camera->setImageSize(Size(640, 640));
    const Vec2d range(700, 1800);
    for (int coefficients : {4, 8})
        CHECK_THROWS_WITH(requireNear(fitCentralCamera(camera, range, coefficients, "camera1"), "camera1"),
                          Catch::Contains("camera1") && Catch::Contains("too wide") && Catch::Contains("--to=opencv, ros or colmap"));
    const CentralCamera fisheye = fitCentralCamera(camera, range, 0, "camera1");
    CHECK_NOTHROW(requireNear(fisheye, "camera1"));
    // Grazing rays meet z = 1800 a hundred metres away: lengths are those of a scene.
    CHECK(fisheye.error.max < 2);
    CHECK(fisheye.error.lengthMax < 2*fisheye.error.max/240*2*range[1]);
    CHECK(fisheye.error.lengthRms > 0.1*fisheye.error.rms/240*range[0]);
}

TEST_CASE("A range before or in the window has no central camera", "[tools][export]")
{
    CHECK_THROWS_WITH(fitCentralCamera(cameraBehind(GlassWindow(Vec3d(0, 0, 1), 25, 1.5, 60)), Vec2d(10, 50), 8, "camera1"),
                      Catch::Contains("camera1") && Catch::Contains("beyond its window"));
}

namespace {

//! A wide splined lens that bends as a fisheye lens does.
Ptr<RefractiveCamera> splinedCamera()
{
    const int nx = 14, ny = 11;
    std::vector<double> intrinsics = {400, 402, 318, 243};
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++)
        {
            const Vec2d p((i - 0.5*(nx - 1))*0.16, (j - 0.5*(ny - 1))*0.16);
            const double bend = 0.03*p.dot(p) + 0.004*std::sin(3*p[0] + p[1]);
            intrinsics.insert(intrinsics.end(), {bend*p[0], bend*p[1]});
        }
    const Ptr<RefractiveCamera> camera =
        RefractiveCamera::createMrcal("LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=14_Ny=11_fov_x_deg=95", intrinsics);
    camera->setImageSize(Size(640, 480));
    return camera;
}

} // namespace

TEST_CASE("A splined lens without a window is its own central camera", "[tools][export]")
{
    const Ptr<RefractiveCamera> camera = splinedCamera();
    const CentralCamera central = centralCamera(camera, Vec2d(400, 1200));
    CHECK(central.error.max < 1e-9);
    CHECK(central.camera->lensModel() == camera->lensModel());
}
