// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "test_scene.hpp"

namespace opencv_test { namespace {

using namespace scene;

// The pane as its data sheet has it, straight ahead.
GlassWindow straight(const GlassWindow& window) { return GlassWindow(Vec3d(0, 0, 1), 20, 1.5437, window.distance); }

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
    const GlassRigResult result = stereoCalibrateGlass(boards(), views(bare1()), views(camera1()), views(bare2(), true),
                                                       views(camera2(), true), first, second, rotation, translation, rvecs, tvecs);
    EXPECT_NEAR(0, result.rms, 1e-6);
    EXPECT_NEAR(0, angle(first->window().normal, window1().normal), 1e-6);
    EXPECT_NEAR(0, angle(second->window().normal, window2().normal), 1e-6);
    EXPECT_EQ(Size(4, 5), result.perViewErrors.size());
    EXPECT_EQ((int)(first->parameterNames().size() + second->parameterNames().size()) + 6, result.stdDeviations.rows);

    EXPECT_REFUSED(stereoCalibrateGlass(boards(), noArray(), views(camera1()), noArray(), PixelViews(1), first,
                                        second, rotation, translation, rvecs, tvecs),
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

TEST(Refract_SelectLensCoefficients, finds_k1_and_k2)
{
    std::vector<std::vector<Mat> > direct = asMats(views(bare1()), views(bare1()));
    direct.resize(1);
    const Mat none(8, 1, CV_64F, Scalar(0));
    const std::vector<Ptr<RefractiveCamera> > cameras(1, RefractiveCamera::create(K1(), none));
    Mat scores;
    cv::RNG random(1);
    for (size_t i = 0; i < direct[0].size(); i++)
    {
        Mat noise(direct[0][i].size(), CV_64FC2);
        random.fill(noise, cv::RNG::NORMAL, 0, 0.05);
        direct[0][i] += noise;
    }
    const int flags = selectLensCoefficients(boards(), direct, std::vector<std::vector<Mat> >(), cameras, std::vector<int>(),
                                             noArray(), noArray(), 0, scores);
    EXPECT_EQ(Size(4, 8), scores.size());
    EXPECT_TRUE((flags & GLASS_FIX_K4) != 0);
    EXPECT_TRUE((flags & GLASS_FIX_K1) == 0);
    EXPECT_NEAR(-0.41, cameras[0]->distCoeffs().at<double>(0), 0.1);
    EXPECT_EQ(0, cameras[0]->distCoeffs().at<double>(5));
    EXPECT_GT(scores.at<double>(0, 2), 2*scores.at<double>(2, 2));
    EXPECT_REFUSED(selectLensCoefficients(boards(), direct, std::vector<std::vector<Mat> >(), cameras, std::vector<int>(),
                                          noArray(), noArray(), GLASS_USE_POSES), "has no meaning here");
}

TEST(Refract_CalibrateGlassRig, finds_windows_and_a_wrong_point)
{
    std::vector<Ptr<RefractiveCamera> > cameras;
    cameras.push_back(RefractiveCamera::create(K1(), D1(), straight(window1())));
    cameras.push_back(RefractiveCamera::create(K2(), D2(), straight(window2())));
    std::vector<Mat> Rs(2), Ts(2), rvecs, tvecs;
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
    GlassRigOptions options(GLASS_ROBUST);
    const GlassRigResult result = calibrateGlassRig(boards(), direct, glass, cameras, windows, Rs, Ts, rvecs, tvecs, options);
    EXPECT_NEAR(0, result.rms, 1e-6);
    EXPECT_NEAR(0, angle(cameras[0]->window().normal, window1().normal), 1e-6);
    EXPECT_NEAR(0, angle(cameras[1]->window().normal, window2().normal), 1e-6);
    EXPECT_EQ(Size(4, 5), result.imageStatus.size());
    EXPECT_EQ(0, cv::countNonZero(result.imageStatus));
    ASSERT_EQ(20u, result.inliers.size());
    EXPECT_EQ(29, cv::countNonZero(result.inliers[4*3 + 1]));
    EXPECT_EQ(0, result.inliers[4*3 + 1].at<uchar>(7));

    Rs[0].at<double>(0, 1) = 1e-8;
    windows.clear();                // each its own
    EXPECT_NEAR(0, calibrateGlassRig(boards(), direct, asMats(views(camera1()), views(camera2(), true)), cameras, windows,
                                     Rs, Ts, rvecs, tvecs, GLASS_FREE_EXTRINSICS), 1e-6);
    EXPECT_NEAR(590, tvecs[0].at<double>(2), 1e-3);

    options.targetCovariance = 1e-6*Mat::eye(7, 7, CV_64F);
    const GlassRigResult moved = calibrateGlassRig(boards(), direct, glass, cameras, windows, Rs, Ts, rvecs, tvecs, options);
    EXPECT_EQ(Size(1, 7), moved.targetErrors.size());
    EXPECT_NEAR(0, cv::norm(moved.targetErrors, cv::NORM_INF), 1e-6);
    EXPECT_EQ(result.stdDeviations.rows + 7, moved.stdDeviations.rows);
    EXPECT_GT(1.001e-3, moved.stdDeviations.at<double>(moved.stdDeviations.rows - 7));
    options.targetCovariance = Mat::eye(6, 6, CV_64F);
    EXPECT_REFUSED(calibrateGlassRig(boards(), direct, glass, cameras, windows, Rs, Ts, rvecs, tvecs, options),
                   "targetCovariance is 6x6");

    windows.resize(1);
    EXPECT_REFUSED(calibrateGlassRig(boards(), direct, glass, cameras, windows, Rs, Ts, rvecs, tvecs, GlassRigOptions()),
                   "windowOfCamera has 1 elements");
}

// Two standing cameras and known distances between some of the points.
TEST(Refract_BundleAdjust, finds_both_windows)
{
    std::vector<Point3d> points;
    std::vector<Vec4d> lengths;
    for (int i = 0; i < 40; i++)
    {
        const Point3d end(25.*(i % 7) - 75, 22.*(i % 5) - 44, 560 + 11.*(i % 9));
        points.push_back(end);
        points.push_back(end + Point3d(30*std::cos(1.7*i), 30*std::sin(1.7*i), 20*std::sin(2.3*i)));
        lengths.push_back(Vec4d(2*i, 2*i + 1, cv::norm(points[2*i + 1] - points[2*i]), 0.01));
    }
    std::vector<std::vector<Point2d> > pixels;
    pixels.push_back(project(points, camera1()));
    pixels.push_back(project(points, camera2(), R(), T()));
    std::vector<Ptr<RefractiveCamera> > cameras;
    cameras.push_back(RefractiveCamera::create(K1(), D1(), straight(window1())));
    cameras.push_back(RefractiveCamera::create(K2(), D2(), straight(window2())));
    std::vector<Mat> Rs(2), Ts(2);
    Rs[0] = Mat::eye(3, 3, CV_64F);
    Rs[1] = Mat(R());
    Ts[0] = Mat::zeros(3, 1, CV_64F);
    Ts[1] = Mat(T());
    std::vector<Point3d> found;
    EXPECT_NEAR(0, refractiveBundleAdjust(pixels, cameras, std::vector<int>(), Rs, Ts, found, lengths), 1e-5);
    EXPECT_NEAR(0, angle(cameras[0]->window().normal, window1().normal), 1e-5);
    EXPECT_NEAR(0, angle(cameras[1]->window().normal, window2().normal), 1e-5);
    ASSERT_EQ(points.size(), found.size());
    EXPECT_NEAR(0, cv::norm(found[17] - points[17]), 1e-3);

    // The same as a list of observations.
    std::vector<Vec3i> observations;
    std::vector<Point2d> listed;
    for (int camera = 0; camera < 2; camera++)
        for (int point = 0; point < (int)points.size(); point++)
        {
            observations.push_back(Vec3i(0, camera, point));
            listed.push_back(pixels[camera][point]);
        }
    std::vector<Mat> rvecs(1, Mat::zeros(3, 1, CV_64F)), tvecs(1, Mat::zeros(3, 1, CV_64F));
    std::vector<Point3d> again;
    const BundleAdjustOptions options;
    const BundleAdjustResult result = refractiveBundleAdjust(observations, listed, cameras, std::vector<int>(), Rs, Ts, rvecs, tvecs,
                                                             again, lengths, options);
    EXPECT_NEAR(0, result.rms, 1e-5);
    ASSERT_EQ(points.size(), again.size());
    EXPECT_NEAR(0, cv::norm(again[17] - points[17]), 1e-3);
    ASSERT_EQ(1u, result.inliers.size());
    EXPECT_EQ((int)listed.size(), countNonZero(result.inliers[0]));
    ASSERT_EQ(1u, result.viewCovariances.size());
    EXPECT_EQ((int)points.size(), result.pointDeviations.rows);
    observations[5][1] = 2;
    EXPECT_REFUSED(refractiveBundleAdjust(observations, listed, cameras, std::vector<int>(), Rs, Ts, rvecs, tvecs, again, lengths,
                                          options),
                   "observations[5] is of camera 2");
}

}} // namespace
