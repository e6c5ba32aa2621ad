// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "test_scene.hpp"

namespace opencv_test { namespace {

using namespace scene;

Ptr<RefractiveCamera> bare1() { return RefractiveCamera::create(K1(), D1()); }
Ptr<RefractiveCamera> bare2() { return RefractiveCamera::create(K2(), D2()); }
// The pane as its data sheet has it, straight ahead.
GlassWindow straight(const GlassWindow& window) { return GlassWindow(Vec3d(0, 0, 1), 20, 1.5437, window.distance); }

TEST(Refract_CalibrateGlassNormal, from_pairs)
{
    Vec3d normal;
    Vec2d center;
    Matx33d covariance;
    const double rms = calibrateGlassNormal(views(bare1()), views(camera1()), K1(), D1(), normal, center, covariance);
    const Vec3d n = window1().normal;
    EXPECT_NEAR(0, rms, 1e-6);
    EXPECT_NEAR(0, angle(normal, n), 1e-8);
    EXPECT_NEAR(K1()(0, 2) + K1()(0, 0)*n[0]/n[2], center[0], 1e-3);
    EXPECT_NEAR(K1()(1, 2) + K1()(1, 1)*n[1]/n[2], center[1], 1e-3);

    Vec3d same;
    calibrateGlassNormal(views(bare1()), views(camera1()), bare1(), same);
    EXPECT_EQ(normal, same);
}

TEST(Refract_CalibrateGlassNormal, refuses_views_that_do_not_differ)
{
    Vec3d normal;
    EXPECT_REFUSED(calibrateGlassNormal(views(bare1()), views(bare1()), K1(), D1(), normal),
                   "the normal is undetermined");
    EXPECT_REFUSED(calibrateGlassNormal(PixelViews(2), views(camera1()), K1(), D1(), normal),
                   "imagePointsDirect has 2 views");
}

TEST(Refract_CalibrateGlass, from_pairs)
{
    GlassWindow window = straight(window1());
    window.thickness[0] = 15;
    std::vector<Vec3d> rvecs, tvecs;
    const double rms = calibrateGlass(boards(), views(bare1()), views(camera1()), K1(), D1(), window, rvecs, tvecs,
                                      GLASS_FREE_THICKNESS);
    EXPECT_NEAR(0, rms, 1e-6);
    EXPECT_NEAR(0, angle(window.normal, window1().normal), 1e-6);
    EXPECT_NEAR(20, window.thickness[0], 1e-4);
    ASSERT_EQ(5u, rvecs.size());
    EXPECT_NEAR(590, tvecs[0][2], 1e-3);
}

TEST(Refract_CalibrateGlass, without_pairs)
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K1(), D1(), straight(window1()));
    std::vector<Vec3d> rvecs, tvecs;
    Mat deviations, covariance, perView, jacobian;
    const double rms = calibrateGlass(boards(), noArray(), views(camera1()), camera, rvecs, tvecs,
                                      deviations, covariance, perView, jacobian);
    EXPECT_NEAR(0, rms, 1e-6);
    EXPECT_NEAR(0, angle(camera->window().normal, window1().normal), 1e-6);
    const int parameters = 8 + 8;           // lens; normal, distance, one layer, two media
    EXPECT_EQ(Size(1, parameters), deviations.size());
    EXPECT_EQ(Size(parameters, parameters), covariance.size());
    EXPECT_EQ(Size(2, 5), perView.size());
    EXPECT_EQ(Size(parameters + 6*5, 2*30*5), jacobian.size());
}

TEST(Refract_CalibrateGlass, refuses_what_cannot_be_seen)
{
    GlassWindow window = straight(window1());
    std::vector<Vec3d> rvecs, tvecs;
    const auto why = [&](int flags) { return thrown([&] {
        calibrateGlass(boards(), views(bare1()), views(camera1()), K1(), D1(), window, rvecs, tvecs, flags); }); };
    EXPECT_TRUE(contains(why(GLASS_FREE_DISTANCE), "GLASS_FREE_DISTANCE"));     // no effect in air
    EXPECT_TRUE(contains(why(GLASS_FREE_INTRINSICS), "GLASS_FREE_INTRINSICS")); // no camera to return the lens in
    EXPECT_TRUE(contains(why(1 << 20), "flags"));
}

TEST(Refract_StereoCalibrateGlass, finds_both_windows)
{
    const Ptr<RefractiveCamera> first = RefractiveCamera::create(K1(), D1(), straight(window1())),
                                second = RefractiveCamera::create(K2(), D2(), straight(window2()));
    Mat rotation(R()), translation(T());
    std::vector<Vec3d> rvecs, tvecs;
    Mat deviations, covariance, perView;
    const double rms = stereoCalibrateGlass(boards(), views(bare1()), views(camera1()), views(bare2(), true),
                                            views(camera2(), true), first, second, rotation, translation, rvecs, tvecs,
                                            deviations, covariance, perView);
    EXPECT_NEAR(0, rms, 1e-6);
    EXPECT_NEAR(0, angle(first->window().normal, window1().normal), 1e-6);
    EXPECT_NEAR(0, angle(second->window().normal, window2().normal), 1e-6);
    EXPECT_EQ(Size(4, 5), perView.size());

    EXPECT_REFUSED(stereoCalibrateGlass(boards(), noArray(), views(camera1()), noArray(), PixelViews(1), first,
                                        second, rotation, translation, rvecs, tvecs, deviations, covariance, perView),
                   "imagePointsRefracted2");
}

std::vector<std::vector<Mat> > asMats(const PixelViews& first, const PixelViews& second)
{
    std::vector<std::vector<Mat> > cameras(2);
    for (size_t i = 0; i < first.size(); i++)
    {
        cameras[0].push_back(Mat(first[i], true));
        cameras[1].push_back(Mat(second[i], true));
    }
    return cameras;
}

TEST(Refract_CalibrateGlassRig, finds_windows_and_a_wrong_point)
{
    std::vector<Ptr<RefractiveCamera> > cameras;
    cameras.push_back(RefractiveCamera::create(K1(), D1(), straight(window1())));
    cameras.push_back(RefractiveCamera::create(K2(), D2(), straight(window2())));
    std::vector<Mat> Rs(2), Ts(2), rvecs, tvecs, inliers;
    Rs[0] = Mat::eye(3, 3, CV_64F);
    Rs[1] = Mat(R());
    Ts[0] = Mat::zeros(3, 1, CV_64F);
    Ts[1] = Mat(T());
    std::vector<int> windows(2);
    windows[1] = 1;
    PixelViews glass1 = views(camera1());
    glass1[3][7].x += 5;
    const std::vector<std::vector<Mat> > glass = asMats(glass1, views(camera2(), true)),
                                         direct = asMats(views(bare1()), views(bare2(), true));
    Mat deviations, covariance, perView, status, others;
    const double rms = calibrateGlassRig(boards(), direct, glass, cameras, windows, Rs, Ts, rvecs, tvecs, deviations,
                                         covariance, perView, status, inliers, others, GLASS_ROBUST);
    EXPECT_NEAR(0, rms, 1e-6);
    EXPECT_NEAR(0, angle(cameras[0]->window().normal, window1().normal), 1e-6);
    EXPECT_NEAR(0, angle(cameras[1]->window().normal, window2().normal), 1e-6);
    EXPECT_EQ(Size(4, 5), status.size());
    EXPECT_EQ(0, cv::countNonZero(status));
    ASSERT_EQ(20u, inliers.size());
    EXPECT_EQ(29, cv::countNonZero(inliers[4*3 + 1]));
    EXPECT_EQ(0, inliers[4*3 + 1].at<uchar>(7));

    Rs[0].at<double>(0, 1) = 1e-8;
    windows.clear();                // each its own
    EXPECT_NEAR(0, calibrateGlassRig(boards(), direct, asMats(views(camera1()), views(camera2(), true)), cameras, windows,
                                     Rs, Ts, rvecs, tvecs, GLASS_FREE_EXTRINSICS), 1e-6);
    EXPECT_NEAR(590, tvecs[0].at<double>(2), 1e-3);

    windows.resize(1);
    EXPECT_REFUSED(calibrateGlassRig(boards(), direct, glass, cameras, windows, Rs, Ts, rvecs, tvecs, deviations,
                                     covariance, perView, status, inliers, others), "windowOfCamera has 1 elements");
}

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
