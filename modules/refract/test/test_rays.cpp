// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "test_scene.hpp"

namespace opencv_test { namespace {

using namespace scene;

TEST(Refract_Project, without_window_is_a_pinhole)
{
    std::vector<Point2d> pixels;
    refractiveProjectPoints(scenePoints(), Vec3d(), Vec3d(), K1(), noArray(), GlassWindow(), pixels);
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const Point3d X = scenePoints()[i];
        EXPECT_NEAR(K1()(0, 0)*X.x/X.z + K1()(0, 2), pixels[i].x, 1e-9);
        EXPECT_NEAR(K1()(1, 1)*X.y/X.z + K1()(1, 2), pixels[i].y, 1e-9);
    }
}

// Forwards by Snell's law from an angle of departure, and back by the call.
TEST(Refract_Project, follows_snells_law)
{
    const double distance = 30, thickness = 20, index = 1.5, water = 1.33, z = 400;
    const GlassWindow window(Vec3d(0, 0, 1), thickness, index, distance, water);
    for (int degrees = 0; degrees < 80; degrees += 10)
    {
        const double tangent = std::tan(degrees*CV_PI/180), sine = std::sin(degrees*CV_PI/180);
        const double x = distance*tangent + thickness*std::tan(std::asin(sine/index))
                       + (z - distance - thickness)*std::tan(std::asin(sine/water));
        std::vector<Point2d> pixel;
        refractiveProjectPoints(std::vector<Point3d>(1, Point3d(x, 0, z)), Vec3d(), Vec3d(), Matx33d::eye(), noArray(),
                                window, pixel);
        EXPECT_NEAR(tangent, pixel[0].x, 1e-12*(1 + tangent));
        EXPECT_NEAR(0, pixel[0].y, 1e-12);
    }
}

TEST(Refract_Project, both_overloads_and_both_depths_agree)
{
    std::vector<Point2d> first;
    std::vector<Point2f> second;
    refractiveProjectPoints(scenePoints(), R(), T(), K2(), D2(), window2(), first);
    refractiveProjectPoints(Mat(scenePoints()), R(), T(), camera2(), second);
    const std::vector<Point2d> third = project(scenePoints(), camera2(), R(), T());
    ASSERT_EQ(first.size(), second.size());
    for (size_t i = 0; i < first.size(); i++)
    {
        EXPECT_EQ(first[i], third[i]);
        EXPECT_EQ(Point2f(first[i]), second[i]);
    }
}

TEST(Refract_Project, says_why_a_point_has_no_image)
{
    const std::vector<Point3d> points = { Point3d(0, 0, 600), Point3d(0, 0, 40), Point3d(NaN, 0, 600) };
    std::vector<Point2d> pixels;
    std::vector<uchar> status;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera1(), pixels, status);
    EXPECT_EQ(std::vector<uchar>({ REFRACT_OK, REFRACT_BEHIND_WINDOW, REFRACT_NOT_FINITE }), status);
    EXPECT_FALSE(cvIsNaN(pixels[0].x) || cvIsNaN(pixels[0].y));
    for (int i = 1; i < 3; i++)
        EXPECT_TRUE(cvIsNaN(pixels[i].x) && cvIsNaN(pixels[i].y));

    refractiveProjectPoints(std::vector<Point3d>(), Vec3d(), Vec3d(), camera1(), pixels, status);
    EXPECT_TRUE(pixels.empty() && status.empty());
    EXPECT_REFUSED(refractiveProjectPoints(points, Vec3d(), Vec3d(), Ptr<RefractiveCamera>(), pixels),
                   "camera is empty");
    EXPECT_REFUSED(refractiveProjectPoints(Mat(4, 4, CV_64F, Scalar(1)), Vec3d(), Vec3d(), camera1(), pixels),
                   "objectPoints");
}

TEST(Refract_Project, jacobian_is_the_difference_quotient)
{
    const std::vector<Point3d> points(1, Point3d(80, -60, 20));
    const Vec3d rvec(0.1, -0.2, 0.3), tvec(10, 20, 600);
    std::vector<Point2d> pixels;
    std::vector<uchar> status;
    Mat jacobian;
    refractiveProjectPoints(points, rvec, tvec, camera1(), pixels, status, jacobian);
    // Pose; fx, fy, cx, cy and four coefficients; normal, distance, one layer, two media.
    ASSERT_EQ(Size(6 + 8 + 8, 2), jacobian.size());

    const double step = 1e-4;
    for (int k = 0; k < 3; k++)
    {
        const Vec3d d(k == 0 ? step : 0, k == 1 ? step : 0, k == 2 ? step : 0);
        std::vector<Point2d> plus, minus;
        refractiveProjectPoints(points, rvec + d, tvec, camera1(), plus);
        refractiveProjectPoints(points, rvec - d, tvec, camera1(), minus);
        EXPECT_NEAR((plus[0].x - minus[0].x)/(2*step), jacobian.at<double>(0, k), 1e-3);
        refractiveProjectPoints(points, rvec, tvec + d, camera1(), plus);
        refractiveProjectPoints(points, rvec, tvec - d, camera1(), minus);
        EXPECT_NEAR((plus[0].y - minus[0].y)/(2*step), jacobian.at<double>(1, 3 + k), 1e-6);
    }
}

TEST(Refract_Unproject, ray_passes_through_the_point)
{
    const std::vector<Point2d> pixels = project(scenePoints(), camera1());
    std::vector<Point3d> origins, directions, origins2, directions2;
    refractiveUnprojectPoints(pixels, origins, directions, camera1());
    refractiveUnprojectPoints(pixels, origins2, directions2, K1(), D1(), window1());
    EXPECT_EQ(origins, origins2);
    EXPECT_EQ(directions, directions2);
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const Vec3d o(origins[i]), d(directions[i]), X(scenePoints()[i]);
        EXPECT_NEAR(1, cv::norm(d), 1e-14);
        EXPECT_NEAR(0, cv::norm(o.cross(window1().normal)), 1e-12);
        EXPECT_NEAR(0, cv::norm(d.cross(X - o)), 1e-8);
    }
}

TEST(Refract_Unproject, total_reflection)
{
    GlassWindow window;                     // looking out of the water at 45 and 50 degrees; the limit is 48.6
    window.innerIndex = 1.333;
    window.distance = 10;
    const std::vector<Point2d> pixels = { Point2d(1, 0), Point2d(std::tan(50*CV_PI/180), 0) };
    std::vector<Point3d> origins, directions;
    std::vector<uchar> status;
    refractiveUnprojectPoints(pixels, origins, directions, Matx33d::eye(), noArray(), window, status);
    EXPECT_EQ(std::vector<uchar>({ REFRACT_OK, REFRACT_TOTAL_REFLECTION }), status);
    EXPECT_NEAR(1.333*std::sqrt(0.5), directions[0].x, 1e-12);
    EXPECT_TRUE(cvIsNaN(directions[1].x) && cvIsNaN(origins[1].z));
}

}} // namespace
