// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "perf_scene.hpp"

// Every call that works on an array of points, for one pane in air and for one before water.

namespace opencv_test { namespace {

PERF_TEST_P(Refract, projectPoints, Scene::all())
{
    makePoints(100000);
    TEST_CYCLE() refractiveProjectPoints(points, rvec, tvec, camera2, pixels2);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, projectPoints_jacobian, Scene::all())
{
    makePoints(1000);
    Mat status, jacobian;
    TEST_CYCLE() refractiveProjectPoints(points, rvec, tvec, camera2, pixels2, status, jacobian);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, unprojectPoints, Scene::all())
{
    makePoints(100000);
    std::vector<Point3d> origins, directions;
    TEST_CYCLE() refractiveUnprojectPoints(pixels1, origins, directions, camera1);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, undistortPoints, Scene::all())
{
    makePoints(100000);
    const std::vector<double> depth(1, 600.);
    std::vector<Point2d> corrected;
    TEST_CYCLE() refractiveUndistortPoints(pixels1, corrected, camera1, depth);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, pointsOnPlane, Scene::all())
{
    makePoints(100000);
    TEST_CYCLE() refractivePointsOnPlane(pixels1, points, camera1, Vec4d(0, 0, 1, 600));
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, initUndistortRectifyMap, Scene::all())
{
    const std::vector<double> depth(1, 600.);
    Mat map1, map2;
    TEST_CYCLE() initRefractiveUndistortRectifyMap(camera1, depth, noArray(), noArray(), szVGA, CV_16SC2, map1, map2);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, computeEpilines, Scene::all())
{
    makePoints(100);
    std::vector<std::vector<Point2d> > lines;
    TEST_CYCLE() computeRefractiveEpilines(pixels1, 1, camera1, camera2, rvec, tvec, Vec2d(300, 3000), lines);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, triangulate, Scene::all())
{
    makePoints(10000);
    TEST_CYCLE() triangulateRefractive(camera1, camera2, rvec, tvec, pixels1, pixels2, points);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, triangulate_covariance, Scene::all())
{
    makePoints(10000);
    Mat status, covariance;
    TEST_CYCLE() triangulateRefractive(camera1, camera2, rvec, tvec, pixels1, pixels2, points, status, TRIANGULATE_OPTIMAL, 0.1,
                                       noArray(), covariance);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, epipolarDistance, Scene::all())
{
    makePoints(10000);
    std::vector<double> distances;
    TEST_CYCLE() refractiveEpipolarDistance(pixels1, pixels2, camera1, camera2, rvec, tvec, distances);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, splineWeights, Scene::all())
{
    makePoints(10000);
    std::vector<double> intrinsics(4 + 2*9*8);
    intrinsics[0] = intrinsics[1] = 600;
    intrinsics[2] = 320;
    intrinsics[3] = 240;
    const Ptr<RefractiveCamera> splined = RefractiveCamera::createMrcal(
        "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=9_Ny=8_fov_x_deg=110", intrinsics, camera1->window());
    Mat controls, weights;
    TEST_CYCLE() refractiveSplineWeights(points, Vec3d(), Vec3d(), splined, controls, weights);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, distortPoints, Scene::all())
{
    makePoints(100000);
    std::vector<Point2d> ideal, raw;
    refractiveUndistortPoints(pixels1, ideal, camera1, 600.);
    TEST_CYCLE() refractiveDistortPoints(ideal, raw, camera1, 600.);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, triangulate_midpoint, Scene::all())
{
    makePoints(10000);
    TEST_CYCLE() triangulateRefractive(camera1, camera2, rvec, tvec, pixels1, pixels2, points, noArray(),
                                       TRIANGULATE_MIDPOINT);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, solvePnP, Scene::all())
{
    makePoints(100);
    Vec3d r, t;
    TEST_CYCLE() refractiveSolvePnP(points, pixels1, camera1, r, t);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, solvePnPRansac, Scene::all())
{
    makePoints(100);
    for (size_t i = 0; i < pixels1.size(); i += 2)
        pixels1[i] += Point2d(60, -40);
    Vec3d r, t;
    TEST_CYCLE() refractiveSolvePnPRansac(points, pixels1, camera1, r, t);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, recoverPose, Scene::all())
{
    makePoints(1000);
    for (size_t i = 0; i < pixels2.size(); i += 4)
        pixels2[i] += Point2d(60, 40);
    Mat R, t;
    TEST_CYCLE() refractiveRecoverPose(pixels1, pixels2, camera1, camera2, R, t);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, solvePnPGeneric, Scene::all())
{
    makePoints(100);
    std::vector<Vec3d> rs, ts;
    TEST_CYCLE() refractiveSolvePnPGeneric(points, pixels1, camera1, rs, ts);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, solveP3P, Scene::all())
{
    makePoints(4);
    points.pop_back();
    pixels1.pop_back();
    std::vector<Mat> rs, ts;
    TEST_CYCLE() refractiveSolveP3P(points, pixels1, camera1, rs, ts);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, undistortImage, Scene::all())
{
    Mat image(1024, 1280, CV_8UC3, Scalar::all(7)), corrected;
    TEST_CYCLE() refractiveUndistortImage(image, corrected, camera1, 600.);
    SANITY_CHECK_NOTHING();
}

PERF_TEST_P(Refract, initStereoRectifyMap, Scene::all())
{
    Mat R1, R2, P1, P2, Q, map1, map2;
    refractiveStereoRectify(camera1, camera2, rvec, tvec, Size(1280, 1024), Vec2d(400, 1000), R1, R2, P1, P2, Q);
    TEST_CYCLE() initRefractiveStereoRectifyMap(camera2, 600., R2, P2, tvec, szVGA, CV_16SC2, map1, map2);
    SANITY_CHECK_NOTHING();
}

}} // namespace
