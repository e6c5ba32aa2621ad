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

TEST(Refract_UndistortPoints, one_depth_serves_four_points)
{
    std::vector<Point3d> plane;
    for (int i = 0; i < 4; i++)
        plane.push_back(Point3d(40*i - 60, 30 - 20*i, 600));
    const std::vector<Point2d> raw = project(plane, camera1());
    std::vector<Point2d> normalized, same;
    refractiveUndistortPoints(raw, normalized, camera1(), 600.);
    refractiveUndistortPoints(raw, same, K1(), D1(), window1(), 600.);
    EXPECT_EQ(normalized, same);
    for (int i = 0; i < 4; i++)
        EXPECT_NEAR(0, cv::norm(normalized[i] - Point2d(plane[i].x/600, plane[i].y/600)), 1e-12);
    EXPECT_REFUSED(refractiveUndistortPoints(raw, normalized, camera1(), Scalar(600)), "for four points");
    EXPECT_REFUSED(refractiveUndistortPoints(raw, normalized, camera1(), 0.), "depth is 0 (Python: None)");
}

TEST(Refract_DistortPoints, is_the_way_back)
{
    const std::vector<Point2d> raw = project(scenePoints(), camera1());
    std::vector<double> depth;
    for (const Point3d& X : scenePoints())
        depth.push_back(X.z);
    std::vector<Point2d> ideal, back, same;
    refractiveUndistortPoints(raw, ideal, camera1(), depth, Vec3d(0.1, 0, 0), K2());
    refractiveDistortPoints(ideal, back, camera1(), depth, Vec3d(0.1, 0, 0), K2());
    refractiveDistortPoints(ideal, same, K1(), D1(), window1(), depth, Vec3d(0.1, 0, 0), K2());
    EXPECT_EQ(back, same);
    for (size_t i = 0; i < raw.size(); i++)
        EXPECT_NEAR(0, cv::norm(back[i] - raw[i]), 1e-7);
}

TEST(Refract_UndistortImage, shows_the_plane)
{
    const Matx33d newK = getOptimalNewRefractiveCameraMatrix(camera1(), 600., Size(1280, 1024), 1);
    const std::vector<Point3d> dot(1, Point3d(60, -40, 600));
    const Point2d raw = project(dot, camera1())[0];
    Mat image = Mat::zeros(1024, 1280, CV_8U), corrected;
    image(Rect(cvRound(raw.x) - 3, cvRound(raw.y) - 3, 7, 7)) = Scalar(255);
    refractiveUndistortImage(image, corrected, camera1(), 600., newK);
    ASSERT_EQ(image.size(), corrected.size());
    EXPECT_EQ(255, corrected.at<uchar>(cvRound(newK(1, 1)*dot[0].y/600 + newK(1, 2)), cvRound(newK(0, 0)*dot[0].x/600 + newK(0, 2))));
}

TEST(Refract_FrameAxes, end_where_the_window_shows_them)
{
    Mat image = Mat::zeros(1024, 1280, CV_8UC3);
    const Vec3d rvec(0.4, -0.5, 0.1), tvec(0, 0, 600);
    drawRefractiveFrameAxes(image, camera1(), rvec, tvec, 60, 1);
    for (int axis = 0; axis < 3; axis++)
    {
        std::vector<Vec3d> end(1);
        end[0][axis] = 60;
        std::vector<Point2d> pixel;
        refractiveProjectPoints(end, rvec, tvec, camera1(), pixel);
        EXPECT_EQ(255, (int)image.at<Vec3b>(Point(pixel[0]))[2 - axis]);     // x red, y green, z blue
    }
    EXPECT_REFUSED(drawRefractiveFrameAxes(image, camera1(), rvec, tvec, -1), "length is -1");
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
