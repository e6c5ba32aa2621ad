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

TEST(Refract_SolvePnP, no_pose_is_false)
{
    const std::vector<Point2d> unseen(board().size(), Point2d(NaN, NaN));
    Vec3d r, t(1, 2, 3);
    EXPECT_FALSE(refractiveSolvePnP(board(), unseen, camera1(), r, t));
    EXPECT_EQ(Vec3d(1, 2, 3), t);
    EXPECT_REFUSED(refractiveSolvePnP(board(), std::vector<Point2d>(3), camera1(), r, t), "imagePoints 3");
}

}} // namespace
