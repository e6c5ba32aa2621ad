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

TEST(Refract_EpipolarDistance, is_that_of_the_moved_pixel)
{
    const std::vector<Point2d> pixels1 = project(scenePoints(), camera1()),
                               pixels2 = project(scenePoints(), camera2(), R(), T());
    std::vector<double> none, up, byCamera, same;
    std::vector<Point2d> moved = pixels2;
    for (Point2d& p : moved)
        p.y -= 3;
    Mat status, depths, jacobian;
    refractiveEpipolarDistance(pixels1, pixels2, camera1(), camera2(), R(), T(), none, status);
    refractiveEpipolarDistance(pixels1, moved, camera1(), camera2(), R(), T(), up, status, 1, Vec2d(0, INF), depths, jacobian);
    refractiveEpipolarDistance(pixels1, moved, K1(), D1(), window1(), K2(), D2(), window2(), R(), T(), same);
    refractiveEpipolarDistance(pixels1, moved, camera1(), camera2(), R(), T(), byCamera);
    EXPECT_EQ(byCamera, same);
    EXPECT_EQ(0, cv::countNonZero(status));
    for (size_t i = 0; i < none.size(); i++)
    {
        EXPECT_NEAR(0, none[i], 1e-6);
        // To first order the distance by v2 times 3 px.
        EXPECT_NEAR(-3*jacobian.at<double>((int)i, 3), up[i], 0.02);
        EXPECT_GT(std::abs(up[i]), 2.5);
        EXPECT_NEAR(scenePoints()[i].z, depths.at<double>((int)i), 10);
    }
    EXPECT_REFUSED(refractiveEpipolarDistance(pixels1, moved, camera1(), camera2(), R(), T(), up, noArray(), 3), "whichImage is 3");
}

TEST(Refract_Triangulate, tells_the_reprojection_errors)
{
    std::vector<Point2d> pixels1 = project(scenePoints(), camera1()), pixels2 = project(scenePoints(), camera2(), R(), T());
    pixels2[4].y += 2;
    Mat points, status, covariance, errors;
    triangulateRefractive(camera1(), camera2(), R(), T(), pixels1, pixels2, points, status, TRIANGULATE_OPTIMAL, 0.1, noArray(),
                          covariance, errors);
    ASSERT_EQ(Size(2, 30), errors.size());
    for (int i = 0; i < errors.rows; i++)
        for (int c = 0; c < 2; c++)
            EXPECT_EQ(i == 4, errors.at<double>(i, c) > 0.5);
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

TEST(Refract_Triangulate, by_three_cameras_of_a_file)
{
    std::vector<Ptr<RefractiveCamera> > cameras(1, camera1());
    cameras.push_back(camera2());
    cameras.push_back(camera1()->clone());
    std::vector<Mat> Rs(1, Mat::eye(3, 3, CV_64F)), Ts(1, Mat::zeros(3, 1, CV_64F));
    Rs.push_back(Mat(R()));
    Ts.push_back(Mat(T()));
    Rs.push_back((Mat_<double>(3, 1) << 0, -0.3, 0));
    Ts.push_back((Mat_<double>(3, 1) << 180, 0, 25));
    const String filename = cv::tempfile(".yml");
    writeRig(filename, cameras, Rs, Ts);
    readRig(filename, cameras, Rs, Ts);
    remove(filename.c_str());
    ASSERT_EQ(3u, cameras.size());
    PixelViews pixels;
    for (int c = 0; c < 3; c++)
        pixels.push_back(project(scenePoints(), cameras[c], Matx33d(Rs[c]), Vec3d(Ts[c])));
    const double none = std::numeric_limits<double>::quiet_NaN();
    pixels[1][0] = pixels[1][1] = pixels[2][1] = Point2d(none, none);
    std::vector<Point3d> points;
    std::vector<uchar> status;
    triangulateRefractive(cameras, Rs, Ts, pixels, points, status);
    EXPECT_EQ(REFRACT_TOO_FEW_VIEWS, status[1]);
    EXPECT_TRUE(cvIsNaN(points[1].x));
    for (size_t i = 0; i < points.size(); i++)
        EXPECT_NEAR(0, i == 1 ? 0. : cv::norm(points[i] - scenePoints()[i]), 1e-6);
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

TEST(Refract_Stereo, rectified_rows_agree_and_points_are_exact)
{
    const Size size(1280, 1024);
    Mat R1, R2, P1, P2, Q;
    Rect roi1, roi2;
    const Vec2d rows = refractiveStereoRectify(camera1(), camera2(), R(), T(), size, Vec2d(450, 1200), R1, R2, P1, P2, Q, 0, -1,
                                               Size(), &roi1, &roi2);
    EXPECT_LT(rows[0], 0.2);
    EXPECT_LT(rows[1], 1.5);
    EXPECT_GT(roi1.area(), size.area()/2);
    const std::vector<Point2d> raw1 = project(scenePoints(), camera1()), raw2 = project(scenePoints(), camera2(), R(), T());
    for (size_t i = 0; i < raw1.size(); i += 7)
    {
        const Matx31d X = Matx33d(R1)*Matx31d(scenePoints()[i].x, scenePoints()[i].y, scenePoints()[i].z);
        const Matx41d h(X(0), X(1), X(2), 1);
        const Matx31d p1 = Matx34d(P1)*h, p2 = Matx34d(P2)*h;
        const Point2d a(p1(0)/p1(2), p1(1)/p1(2)), b(p2(0)/p2(2), p2(1)/p2(2));
        EXPECT_NEAR(a.y, b.y, 1e-8);
        // The map made for the point's depth leads back to the raw pixel, and its disparity to the point.
        const Point pixel(cvRound(a.x), cvRound(a.y));
        const std::vector<double> depth(1, X(2));
        Mat map, none, disparity(size, CV_32F, Scalar(NaN)), points;
        initRefractiveStereoRectifyMap(camera1(), depth, R1, P1, noArray(), size, CV_32FC2, map, none);
        EXPECT_LT(cv::norm(map.at<Point2f>(pixel) - Point2f(raw1[i])), 2.);
        disparity.at<float>(pixel) = (float)(a.x - b.x);
        refractiveReprojectImageTo3D(disparity, points, camera1(), camera2(), R(), T(), R1, R2, P1, P2, depth, depth);
        EXPECT_NEAR(X(2), points.at<Vec3f>(pixel)[2], 1e-3);
    }
}

TEST(Refract_Stereo, depths_of_a_coarse_disparity)
{
    const Size size(640, 512);
    Mat R1, R2, P1, P2, Q, depth1, depth2;
    refractiveStereoRectify(camera1(), camera2(), R(), T(), Size(1280, 1024), Vec2d(450, 1200), R1, R2, P1, P2, Q, 0);
    const Vec4d far = Matx44d(Q)*Vec4d(640, 512, 100, 1);
    Mat disparity(size, CV_16S, Scalar(50));     // of images half as large
    refractiveRectifiedDepth(disparity, P1, P2, Size(1280, 1024), depth1, depth2);
    ASSERT_EQ(Size(1280, 1024), depth1.size());
    EXPECT_NEAR(far[2]/far[3], depth1.at<float>(512, 640), 1e-3*far[2]/far[3]);
    EXPECT_REFUSED(refractiveStereoRectify(camera1(), camera2(), R(), T(), Size(1280, 1024), Vec2d(900, 300), R1, R2, P1, P2, Q),
                   "depthRange");
}

}} // namespace
