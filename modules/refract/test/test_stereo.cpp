// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "test_scene.hpp"

namespace opencv_test { namespace {

using namespace scene;

double distanceToLine(const std::vector<Point2d>& line, const Point2d& p)
{
    double nearest = INF;
    for (size_t i = 1; i < line.size(); i++)
    {
        const Point2d a = line[i - 1], ab = line[i] - a;
        const double t = std::min(1., std::max(0., (p - a).dot(ab)/ab.dot(ab)));
        nearest = std::min(nearest, cv::norm(p - a - t*ab));
    }
    return nearest;
}

TEST(Refract_Epilines, partner_lies_on_the_line)
{
    const std::vector<Point2d> pixels1 = project(scenePoints(), camera1()),
                               pixels2 = project(scenePoints(), camera2(), R(), T());
    PixelViews lines, back, same;
    computeRefractiveEpilines(pixels1, 1, camera1(), camera2(), R(), T(), Vec2d(300, INF), lines, 0.01);
    computeRefractiveEpilines(pixels2, 2, camera1(), camera2(), R(), T(), Vec2d(300, 2000), back, 0.01);
    computeRefractiveEpilines(pixels1, 1, K1(), D1(), window1(), K2(), D2(), window2(), R(), T(), Vec2d(300, INF),
                              same);
    EXPECT_EQ(lines, same);
    ASSERT_EQ(pixels1.size(), lines.size());
    for (size_t i = 0; i < lines.size(); i++)
    {
        EXPECT_LT(distanceToLine(lines[i], pixels2[i]), 0.0105);
        EXPECT_LT(distanceToLine(back[i], pixels1[i]), 0.0105);
        EXPECT_LT(lines[i].size(), 100u);
    }
}

TEST(Refract_Epilines, without_partner)
{
    const std::vector<Point2d> pixel(1, Point2d(640, 500));
    PixelViews lines;
    std::vector<uchar> status;
    const Vec2d insideTheWindow(1, 20);
    computeRefractiveEpilines(pixel, 1, camera1(), camera2(), R(), T(), insideTheWindow, lines, 0.01, status);
    ASSERT_EQ(1u, lines.size());
    EXPECT_TRUE(lines[0].empty());
    EXPECT_NE(REFRACT_OK, status[0]);
    EXPECT_REFUSED(computeRefractiveEpilines(pixel, 3, camera1(), camera2(), R(), T(), Vec2d(300, 900), lines),
                   "whichImage is 3");
    EXPECT_REFUSED(computeRefractiveEpilines(pixel, 1, camera1(), camera2(), R(), T(), Vec2d(900, 300), lines),
                   "depthRange");
}

TEST(Refract_Triangulate, finds_the_points)
{
    const std::vector<Point2d> pixels1 = project(scenePoints(), camera1()),
                               pixels2 = project(scenePoints(), camera2(), R(), T());
    std::vector<Point3d> optimal, midpoint;
    triangulateRefractive(camera1(), camera2(), R(), T(), pixels1, pixels2, optimal);
    triangulateRefractive(K1(), D1(), window1(), K2(), D2(), window2(), R(), T(), pixels1, pixels2, midpoint, noArray(),
                          TRIANGULATE_MIDPOINT);
    for (size_t i = 0; i < optimal.size(); i++)
    {
        EXPECT_NEAR(0, cv::norm(optimal[i] - scenePoints()[i]), 1e-6);
        EXPECT_NEAR(0, cv::norm(midpoint[i] - scenePoints()[i]), 1e-6);
    }
}

// The covariance says how far a point moves when its pixels do.
TEST(Refract_Triangulate, covariance_is_the_spread)
{
    const std::vector<Point3d> truth(1, scenePoints()[7]);
    const Point2d pixel1 = project(truth, camera1())[0], pixel2 = project(truth, camera2(), R(), T())[0];
    const int count = 2000;
    const double sigma = 0.1;
    RNG& rng = theRNG();
    std::vector<Point2d> pixels1, pixels2;
    for (int i = 0; i < count; i++)
    {
        pixels1.push_back(pixel1 + Point2d(rng.gaussian(sigma), rng.gaussian(sigma)));
        pixels2.push_back(pixel2 + Point2d(rng.gaussian(sigma), rng.gaussian(sigma)));
    }
    std::vector<Point3d> points;
    std::vector<uchar> status;
    Mat covariance;
    triangulateRefractive(camera1(), camera2(), R(), T(), pixels1, pixels2, points, status, TRIANGULATE_OPTIMAL, sigma,
                          noArray(), covariance);
    ASSERT_EQ(Size(9, count), covariance.size());
    double variance = 0;
    for (const Point3d& X : points)
        variance += (X.z - truth[0].z)*(X.z - truth[0].z)/count;
    EXPECT_NEAR(1, std::sqrt(variance/covariance.at<double>(0, 8)), 0.1);
}

TEST(Refract_Triangulate, parallel_rays)
{
    const std::vector<Point2d> same(1, Point2d(0, 0));
    const GlassWindow pane(Vec3d(0, 0, 1), 10, 1.5);
    std::vector<Point3d> points;
    std::vector<uchar> status;
    triangulateRefractive(Matx33d::eye(), noArray(), pane, Matx33d::eye(), noArray(), pane, Vec3d(), Vec3d(-100, 0, 0),
                          same, same, points, status);
    EXPECT_EQ(REFRACT_PARALLEL_RAYS, status[0]);
    EXPECT_TRUE(cvIsNaN(points[0].x) && cvIsNaN(points[0].y) && cvIsNaN(points[0].z));
    EXPECT_REFUSED(triangulateRefractive(camera1(), camera2(), R(), T(), same, std::vector<Point2d>(2), points),
                   "points1 has 1 points, points2 2");
}

}} // namespace
