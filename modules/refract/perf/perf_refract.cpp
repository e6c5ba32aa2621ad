// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "perf_precomp.hpp"

// Every call that works on an array of points, for one pane in air and for one before water.

namespace opencv_test { namespace {

enum { AIR, WATER };
CV_ENUM(Scene, AIR, WATER)

class Refract : public TestBaseWithParam<Scene>
{
protected:
    void SetUp() CV_OVERRIDE
    {
        TestBaseWithParam<Scene>::SetUp();
        const double outerIndex = GetParam() == WATER ? 1.333 : 1;
        const Matx33d K(2438, 0, 644, 0, 2438, 500, 0, 0, 1);
        const std::vector<double> D = { -0.4082, 0.4359, 0, 0, 0.1 };
        camera1 = RefractiveCamera::create(K, D, GlassWindow(Vec3d(-0.25, 0.1, 1), 20, 1.54, 50, outerIndex));
        camera2 = RefractiveCamera::create(K, D, GlassWindow(Vec3d(0.18, 0.03, 1), 20, 1.54, 40, outerIndex));
        rvec = Vec3d(0, 0.3, 0);
        tvec = Vec3d(-180, 0, 25);
    }

    //! Points in a grid 160 mm wide, 600 mm away.
    void makePoints(int count)
    {
        const int columns = cvRound(std::sqrt((double)count));
        for (int i = 0; i < count; i++)
            points.push_back(Point3d(160.*(i % columns)/columns - 80, 160.*(i/columns)/columns - 80, 600));
        refractiveProjectPoints(points, Vec3d(), Vec3d(), camera1, pixels1);
        refractiveProjectPoints(points, rvec, tvec, camera2, pixels2);
    }

    Ptr<RefractiveCamera> camera1, camera2;
    Vec3d rvec, tvec;
    std::vector<Point3d> points;
    std::vector<Point2d> pixels1, pixels2;
};

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

}} // namespace
