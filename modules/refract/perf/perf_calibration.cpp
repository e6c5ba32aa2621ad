// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "perf_scene.hpp"

// What needs Ceres: left out where there is none (cmake/ceres.cmake).

namespace opencv_test { namespace {

PERF_TEST_P(Refract, calibrateGlass, Scene::all())
{
    std::vector<std::vector<Point3d> > boards;
    std::vector<std::vector<Point2d> > direct, refracted;
    const Ptr<RefractiveCamera> bare = RefractiveCamera::create(camera1->cameraMatrix(), camera1->distCoeffs());
    makePoints(100);
    for (size_t i = 0; i < points.size(); i++)
        points[i].z = 0;
    for (int view = 0; view < 5; view++)
    {
        const Vec3d r(0.3 - 0.15*view, 0.2*(view % 3) - 0.2, 0), t(0, 0, 600);
        boards.push_back(points);
        direct.push_back(pixels1);
        refracted.push_back(pixels1);
        refractiveProjectPoints(points, r, t, bare, direct.back());
        refractiveProjectPoints(points, r, t, camera1, refracted.back());
    }
    GlassWindow start = camera1->window();
    start.normal = Vec3d(0, 0, 1);
    TEST_CYCLE() calibrateGlass(boards, direct, refracted, RefractiveCamera::create(bare->cameraMatrix(), bare->distCoeffs(), start),
                                noArray(), noArray());
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, bundleAdjust, Scene::all())
{
    makePoints(100);
    for (size_t i = 0; i < points.size(); i++)
        points[i].z += 7.*(i % 11);
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera1, pixels1);
    refractiveProjectPoints(points, rvec, tvec, camera2, pixels2);
    std::vector<std::vector<Point2d> > pixels;
    pixels.push_back(pixels1);
    pixels.push_back(pixels2);
    std::vector<Vec4d> lengths;
    for (int i = 0; i < 50; i++)
        lengths.push_back(Vec4d(i, 99 - i, cv::norm(points[i] - points[99 - i]), 0.01));
    TEST_CYCLE()
    {
        std::vector<Ptr<RefractiveCamera> > cameras;
        cameras.push_back(camera1->clone());
        cameras.push_back(camera2->clone());
        std::vector<Vec3d> Rs(2), Ts(2);
        Rs[1] = rvec;
        Ts[1] = tvec;
        std::vector<Point3d> found;
        refractiveBundleAdjust(pixels, cameras, std::vector<int>(), Rs, Ts, found, lengths);
    }
    SANITY_CHECK_NOTHING();
}
}} // namespace
