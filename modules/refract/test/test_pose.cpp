// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "test_scene.hpp"

namespace opencv_test { namespace {

using namespace scene;

TEST(Refract_SolvePnP, finds_the_pose)
{
    const Vec3d rvec(0, 0.2, 0), tvec(10, -5, 620);
    const std::vector<Point2d> pixels = project(board(), camera1(), rotation(0, 0.2), tvec);
    Vec3d r, t, r2 = rvec, t2 = tvec;
    std::vector<double> error;
    EXPECT_TRUE(refractiveSolvePnP(board(), pixels, K1(), D1(), window1(), r, t, false, error));
    EXPECT_NEAR(0, error[0], 1e-6);
    EXPECT_NEAR(0, cv::norm(r - rvec), 1e-6);
    EXPECT_NEAR(0, cv::norm(t - tvec), 1e-4);
    EXPECT_TRUE(refractiveSolvePnP(board(), pixels, camera1(), r2, t2, true));
    EXPECT_NEAR(0, cv::norm(t2 - tvec), 1e-4);
}

TEST(Refract_SolvePnPGeneric, finds_both_poses_of_a_board)
{
    const Vec3d rvec(0, 0.3, 0), tvec(10, -5, 1200);
    const std::vector<Point2d> pixels = project(board(), camera1(), rotation(0, 0.3), tvec);
    std::vector<Vec3d> rvecs, tvecs;
    std::vector<double> errors;
    EXPECT_EQ(2, refractiveSolvePnPGeneric(board(), pixels, camera1(), rvecs, tvecs, false, noArray(), noArray(), errors));
    EXPECT_NEAR(0, cv::norm(rvecs[0] - rvec), 1e-5);
    EXPECT_GT(errors[1], errors[0]);
    EXPECT_EQ(2, refractiveSolvePnPGeneric(board(), pixels, K1(), D1(), window1(), rvecs, tvecs));
}

TEST(Refract_SolvePnP, states_a_covariance)
{
    const std::vector<Point2d> pixels = project(board(), camera1(), rotation(0, 0.2), Vec3d(10, -5, 620));
    Vec3d r, t;
    Mat error, C, C2, none;
    std::vector<Mat> rvecs, tvecs, Cs;
    EXPECT_TRUE(refractiveSolvePnP(board(), pixels, camera1(), r, t, false, error, C, 0.1));
    EXPECT_EQ(Size(6, 6), C.size());
    EXPECT_GT(C.at<double>(5, 5), 0);
    EXPECT_TRUE(refractiveSolvePnP(board(), pixels, camera1(), r, t, false, error, C2, 0.2));
    EXPECT_NEAR(4, C2.at<double>(3, 3)/C.at<double>(3, 3), 1e-6);
    EXPECT_LT(0, refractiveSolvePnPGeneric(board(), pixels, camera1(), rvecs, tvecs, false, none, none, error, Cs, 0.1));
    EXPECT_EQ(rvecs.size(), Cs.size());
    EXPECT_NEAR(0, cvtest::norm(Cs[0], C, NORM_INF), 1e-8);
}

TEST(Refract_SolveP3P, has_the_pose_among_its_own)
{
    const Vec3d rvec(0, 0.2, 0), tvec(10, -5, 620);
    const std::vector<Point2d> pixels = project(board(), camera1(), rotation(0, 0.2), tvec);
    const int of[4] = { 0, 5, 25, 13 };
    std::vector<Point3d> object;
    std::vector<Point2d> seen;
    for (int i = 0; i < 4; i++)
    {
        object.push_back(board()[of[i]]);
        seen.push_back(pixels[of[i]]);
    }
    std::vector<Vec3d> rvecs, tvecs;
    EXPECT_LT(0, refractiveSolveP3P(object, seen, camera1(), rvecs, tvecs));
    EXPECT_NEAR(0, cv::norm(tvecs[0] - tvec), 1e-3);
    EXPECT_LT(0, refractiveSolveP3P(object, seen, K1(), D1(), window1(), rvecs, tvecs));
    EXPECT_NEAR(0, cv::norm(rvecs[0] - rvec), 1e-5);
    EXPECT_EQ(0, refractiveSolveP3P(std::vector<Point3d>(), std::vector<Point2d>(), camera1(), rvecs, tvecs));
    EXPECT_TRUE(rvecs.empty());
}

TEST(Refract_SolvePnPRansac, leaves_wrong_points_out)
{
    const Vec3d tvec(10, -5, 620);
    std::vector<Point2d> pixels = project(board(), camera1(), rotation(0, 0.2), tvec);
    for (size_t i = 0; i < pixels.size(); i += 4)
        pixels[i] += Point2d(40, -30);
    Vec3d r, t;
    std::vector<int> inliers;
    Mat C;
    EXPECT_TRUE(refractiveSolvePnPRansac(board(), pixels, camera1(), r, t, false, 300, 2, 0.999, inliers));
    EXPECT_EQ(22u, inliers.size());
    EXPECT_NEAR(0, cv::norm(t - tvec), 1e-4);
    EXPECT_TRUE(refractiveSolvePnPRansac(board(), pixels, K1(), D1(), window1(), r, t, false, 300, 2, 0.999, inliers));
    EXPECT_EQ(1, inliers[0]);
    EXPECT_TRUE(refractiveSolvePnPRansac(board(), pixels, camera1(), r, t, false, 300, 2, 0.999, inliers, C, 0.1));
    EXPECT_EQ(Size(6, 6), C.size());
    const std::vector<Point2d> unseen(board().size(), Point2d(NaN, NaN));
    EXPECT_FALSE(refractiveSolvePnPRansac(board(), unseen, camera1(), r, t, false, 300, 2, 0.999, inliers));
    EXPECT_TRUE(inliers.empty());
    EXPECT_FALSE(refractiveSolvePnPRansac(std::vector<Point3d>(), std::vector<Point2d>(), camera1(), r, t));
}

TEST(Refract_RecoverPose, leaves_wrong_matches_out)
{
    const std::vector<Point2d> pixels1 = project(scenePoints(), camera1());
    std::vector<Point2d> pixels2 = project(scenePoints(), camera2(), R(), T());
    for (size_t i = 0; i < pixels2.size(); i += 6)
        pixels2[i] += Point2d(50, 70);
    Mat found, t, C;
    std::vector<uchar> mask;
    Vec2d lengths;
    EXPECT_LE(25, refractiveRecoverPose(pixels1, pixels2, camera1(), camera2(), found, t, 0.999, 1, mask));
    EXPECT_EQ(pixels1.size(), mask.size());
    EXPECT_EQ(1, mask[1]);
    EXPECT_NEAR(0, cv::norm(found, Mat(R())), 1e-2);
    EXPECT_LE(25, refractiveRecoverPose(pixels1, pixels2, K1(), D1(), window1(), K2(), D2(), window2(), found, t));
    EXPECT_LE(25, refractiveRecoverPose(pixels1, pixels2, camera1(), camera2(), found, t, 0.999, 1, mask, C, lengths));
    EXPECT_EQ(Size(6, 6), C.size());
    EXPECT_LE(lengths[0], cv::norm(t));
    EXPECT_EQ(0, refractiveRecoverPose(std::vector<Point2d>(), std::vector<Point2d>(), camera1(), camera2(), found, t));
    EXPECT_REFUSED(refractiveRecoverPose(pixels1, std::vector<Point2d>(3), camera1(), camera2(), found, t), "points2 3");
}

TEST(Refract_SolvePnP, no_pose_is_false)
{
    const std::vector<Point2d> unseen(board().size(), Point2d(NaN, NaN));
    Vec3d r, t(1, 2, 3);
    EXPECT_FALSE(refractiveSolvePnP(board(), unseen, camera1(), r, t));
    EXPECT_EQ(Vec3d(1, 2, 3), t);
    EXPECT_FALSE(refractiveSolvePnP(std::vector<Point3d>(), std::vector<Point2d>(), camera1(), r, t));
    EXPECT_REFUSED(refractiveSolvePnP(board(), std::vector<Point2d>(3), camera1(), r, t), "imagePoints 3");
}

}} // namespace
