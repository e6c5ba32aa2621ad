// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "test_scene.hpp"

namespace opencv_test { namespace {

using namespace scene;

TEST(Refract_UndistortPoints, finds_the_pinhole_image)
{
    const std::vector<Point2d> raw = project(scenePoints(), camera1());
    std::vector<double> depth;
    for (const Point3d& X : scenePoints())
        depth.push_back(X.z);

    std::vector<Point2d> normalized, pixels;
    refractiveUndistortPoints(raw, normalized, camera1(), depth);
    refractiveUndistortPoints(raw, pixels, K1(), D1(), window1(), depth, Vec3d(), K2());
    for (size_t i = 0; i < raw.size(); i++)
    {
        const Point3d X = scenePoints()[i];
        EXPECT_NEAR(X.x/X.z, normalized[i].x, 1e-12);
        EXPECT_NEAR(X.y/X.z, normalized[i].y, 1e-12);
        EXPECT_NEAR(K2()(0, 0)*X.x/X.z + K2()(0, 2), pixels[i].x, 1e-9);
        EXPECT_NEAR(K2()(1, 1)*X.y/X.z + K2()(1, 2), pixels[i].y, 1e-9);
    }
}

TEST(Refract_UndistortPoints, refuses_what_is_no_depth)
{
    const std::vector<Point2d> raw = project(scenePoints(), camera1());
    std::vector<Point2d> points;
    EXPECT_REFUSED(refractiveUndistortPoints(raw, points, camera1(), std::vector<double>(7, 600.)),
                   "depth has 7 values");
    EXPECT_REFUSED(refractiveUndistortPoints(raw, points, camera1(), std::vector<double>(1, -1.)), "depth is -1");

    std::vector<uchar> status;
    std::vector<double> depths(raw.size(), 600.);
    depths[3] = 10;                         // inside the window
    refractiveUndistortPoints(raw, points, camera1(), depths, noArray(), noArray(), status);
    for (size_t i = 0; i < raw.size(); i++)
    {
        EXPECT_EQ(i == 3, status[i] != REFRACT_OK);
        EXPECT_EQ(i == 3, cvIsNaN(points[i].x) != 0);
    }
}

TEST(Refract_UndistortRectifyMap, is_the_raw_image_of_the_plane)
{
    const double depth = 600;
    const Size size(64, 48);
    const Matx33d K(120, 0, 32, 0, 120, 24, 0, 0, 1);
    Mat map, map1, map2;
    initRefractiveUndistortRectifyMap(camera1(), std::vector<double>(1, depth), noArray(), K, size, CV_32FC2,
                                      map, noArray());
    initRefractiveUndistortRectifyMap(K1(), D1(), window1(), Vec4d(0, 0, 1, depth), noArray(), K, size, CV_32FC1,
                                      map1, map2);
    ASSERT_EQ(size, map.size());
    for (int v = 0; v < size.height; v += 8)
        for (int u = 0; u < size.width; u += 8)
        {
            const std::vector<Point3d> X(1, Point3d((u - 32)*depth/120, (v - 24)*depth/120, depth));
            const Point2d expected = project(X, camera1())[0];
            EXPECT_NEAR(expected.x, map.at<Vec2f>(v, u)[0], 1e-3);
            EXPECT_NEAR(expected.y, map.at<Vec2f>(v, u)[1], 1e-3);
            EXPECT_EQ(map.at<Vec2f>(v, u), Vec2f(map1.at<float>(v, u), map2.at<float>(v, u)));
        }
}

TEST(Refract_UndistortRectifyMap, no_answer_is_outside_the_image)
{
    Mat map;
    const std::vector<double> insideTheWindow(1, 40.);
    initRefractiveUndistortRectifyMap(camera1(), insideTheWindow, noArray(), noArray(), Size(8, 8), CV_32FC2,
                                      map, noArray());
    EXPECT_EQ(0, cvtest::norm(map, Mat(8, 8, CV_32FC2, Scalar::all(-1)), NORM_INF));
    EXPECT_REFUSED(initRefractiveUndistortRectifyMap(camera1(), 600., noArray(), noArray(), Size(8, 8), CV_8UC3,
                                                     map, noArray()),
                   "m1type");
}

TEST(Refract_PointsOnPlane, finds_the_points)
{
    std::vector<Point3d> plane;             // 0.2 x - 0.1 y + z = 600
    for (const Point3d& X : board())
        plane.push_back(Point3d(X.x, X.y, 600 - 0.2*X.x + 0.1*X.y));
    const std::vector<Point2d> raw = project(plane, camera1());

    std::vector<Point3d> points, points2;
    refractivePointsOnPlane(raw, points, camera1(), Vec4d(0.2, -0.1, 1, 600));
    refractivePointsOnPlane(raw, points2, K1(), D1(), window1(), Vec4d(0.2, -0.1, 1, 600));
    EXPECT_EQ(points, points2);
    for (size_t i = 0; i < points.size(); i++)
        EXPECT_NEAR(0, cv::norm(points[i] - plane[i]), 1e-8);
}

TEST(Refract_PointsOnPlane, parallel_to_the_ray)
{
    const std::vector<Point2d> raw(1, Point2d(0, 0));
    std::vector<Point3d> points;
    std::vector<uchar> status;
    refractivePointsOnPlane(raw, points, Matx33d::eye(), noArray(), GlassWindow(Vec3d(0, 0, 1), 10, 1.5),
                            Vec4d(1, 0, 0, 5), status);
    EXPECT_EQ(REFRACT_PARALLEL_RAYS, status[0]);
    EXPECT_TRUE(cvIsNaN(points[0].x));
    EXPECT_REFUSED(refractivePointsOnPlane(raw, points, camera1(), Vec4d(0, 0, 0, 1)), "plane is");
}

}} // namespace
