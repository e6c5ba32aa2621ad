// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "test_scene.hpp"

#include "opencv2/core/utility.hpp"

namespace opencv_test { namespace {

using namespace scene;

const int NO_CAUSE = -1;

// What f throws: its cause is NO_CAUSE if it is none, or a cv::Exception of another kind.
template<typename F> CalibrationError errorOf(const F& f)
{
    try { f(); }
    catch (const CalibrationError& e) { return e; }
    catch (const cv::Exception& e) { return CalibrationError((CalibrationError::Cause)NO_CAUSE, e.err, ""); }
    return CalibrationError((CalibrationError::Cause)NO_CAUSE, "no error", "");
}

// Views of a camera whose window starts straight ahead.
struct Mono
{
    Mono() : object(boards()), direct(views(bare1())), glass(views(camera1())),
             window(GlassWindow(Vec3d(0, 0, 1), 20, 1.5437, 50)) {}

    CalibrationError error(int flags = 0, int iterations = 1000)
    {
        return errorOf([&] { run(flags, iterations); });
    }

    void run(int flags, int iterations)
    {
        std::vector<Vec3d> rvecs, tvecs;
        calibrateGlass(object, direct, glass, RefractiveCamera::create(K1(), D1(), window), rvecs, tvecs, flags,
                       TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, iterations, 1e-12));
    }

    ObjectViews object;
    PixelViews direct, glass;
    GlassWindow window;
};

void expectError(CalibrationError::Cause cause, int code, const CalibrationError& e, int view = -1, int camera = -1,
                 int point = -1)
{
    SCOPED_TRACE(e.err);
    EXPECT_EQ(cause, e.cause);
    EXPECT_EQ(code, e.code);
    EXPECT_EQ(view, e.view);
    EXPECT_EQ(camera, e.camera);
    EXPECT_EQ(point, e.point);
    EXPECT_FALSE(e.reason.empty());
    EXPECT_TRUE(contains(e.what(), e.err));
    EXPECT_TRUE(contains(e.what(), "error: ("));
    EXPECT_LT(0, e.line);
}

TEST(Refract_CalibrationError, of_one_camera)
{
    expectError(CalibrationError::NOT_CONVERGED, Error::StsNoConv, Mono().error(0, 1));
    Mono halves;
    halves.window.thickness.assign(2, 10);
    halves.window.index.assign(2, 1.5437);
    expectError(CalibrationError::UNDETERMINED, Error::StsNoConv, halves.error(GLASS_FREE_THICKNESS));

    Mono few;
    few.direct.clear();
    few.object.assign(1, std::vector<Point3d>());
    few.glass.assign(1, std::vector<Point2d>());
    for (int corner : { 0, 5, 24, 29 })
    {
        few.object[0].push_back(board()[corner]);
        few.glass[0].push_back(views(camera1())[0][corner]);
    }
    expectError(CalibrationError::TOO_FEW_POINTS, Error::StsBadArg, few.error());

    Mono hidden;
    hidden.direct[3].clear();
    for (size_t i = 3; i < hidden.glass[3].size(); i++)
        hidden.glass[3][i].x = NaN;
    expectError(CalibrationError::NO_POSE, Error::StsBadArg, hidden.error(), 3);

    Mono far;
    far.window.distance = 900;
    const CalibrationError beyond = far.error();
    expectError(CalibrationError::NO_IMAGE, Error::StsBadArg, beyond, 0, 0, 0);
    EXPECT_TRUE(contains(beyond.err, "view 0 of camera 1, point"));
    EXPECT_FALSE(contains(beyond.reason, "view 0"));

    Mono unseen;
    unseen.glass = PixelViews(5);
    expectError(CalibrationError::WINDOW_NOT_SEEN, Error::StsBadArg, unseen.error(), -1, 0);
}

TEST(Refract_CalibrationError, of_pairs)
{
    Mono swapped;
    std::swap(swapped.direct, swapped.glass);
    expectError(CalibrationError::PAIRS_SWAPPED, Error::StsBadArg, swapped.error());

    Mono moved;
    std::rotate(moved.glass.begin(), moved.glass.begin() + 1, moved.glass.end());
    const CalibrationError contradicting = moved.error();
    expectError(CalibrationError::PAIRS_CONTRADICT, Error::StsBadArg, contradicting);
    EXPECT_TRUE(contains(contradicting.err, "imagePointsDirect"));
    EXPECT_FALSE(contains(contradicting.reason, "imagePoints"));

    std::vector<double> normal;
    expectError(CalibrationError::UNDETERMINED, Error::StsNoConv, errorOf([&] {
        calibrateGlassNormal(views(bare1()), views(bare1()), K1(), D1(), normal); }));
}

TEST(Refract_CalibrationError, of_two_cameras)
{
    const auto stereo = [](double turn, const Vec3d& translation, const PixelViews& second, int flags) {
        return errorOf([&] {
            GlassWindow window = window1();
            window.outerIndex = 1.333;
            Mat rotation(scene::rotation(0.01, turn)), T(translation);
            std::vector<Vec3d> rvecs, tvecs;
            stereoCalibrateGlass(boards(), views(bare1()), views(camera1()), noArray(), second,
                                 RefractiveCamera::create(K1(), D1(), window), camera2(), rotation, T, rvecs, tvecs,
                                 GlassRigOptions(flags));
        }); };
    const PixelViews seen = views(camera2(), true);
    expectError(CalibrationError::WINDOW_NOT_SEEN, Error::StsBadArg, stereo(0.3, T(), PixelViews(5), 0), -1, 1);
    expectError(CalibrationError::LOOKS_AWAY, Error::StsBadArg, stereo(3, T(), seen, GLASS_SHARED_WINDOW), -1, 1);
    expectError(CalibrationError::BEYOND_WINDOW, Error::StsBadArg,
                stereo(0.3, Vec3d(-180, 2, -800), seen, GLASS_SHARED_WINDOW), -1, 1);
}

TEST(Refract_CalibrationError, of_a_robust_fit)
{
    RNG random(1);
    std::vector<std::vector<Mat> > direct(1), glass(1);
    for (int view = 0; view < 5; view++)
    {
        Mat anywhere(30, 2, CV_64F);
        random.fill(anywhere, RNG::UNIFORM, 100, 900);
        glass[0].push_back(anywhere.reshape(2));
        direct[0].push_back(Mat());
    }
    std::vector<Ptr<RefractiveCamera> > cameras(1, camera1());
    std::vector<Mat> Rs, Ts, rvecs, tvecs;
    const CalibrationError e = errorOf([&] {
        calibrateGlassRig(boards(), direct, glass, cameras, std::vector<int>(), Rs, Ts, rvecs, tvecs, GLASS_ROBUST); });
    expectError(CalibrationError::TOO_FEW_INLIERS, Error::StsNoConv, e);
}

// Two cameras see the points in two views.
struct Scene
{
    Scene() : images(2), rvecs(2), tvecs(2)
    {
        tvecs[1] = Vec3d(30, -20, 10);
        rvecs[1] = Vec3d(0, 0.1, 0);
        for (int view = 0; view < 2; view++)
        {
            const Matx33d turn = rotation(0, rvecs[view][1]);
            images[0].push_back(Mat(project(scenePoints(), camera1(), turn, tvecs[view]), true));
            images[1].push_back(Mat(project(scenePoints(), camera2(), R()*turn, R()*tvecs[view] + T()), true));
        }
    }

    CalibrationError error(const std::vector<Vec4d>& lengths, int flags)
    {
        std::vector<Ptr<RefractiveCamera> > cameras;
        cameras.push_back(camera1());
        cameras.push_back(camera2());
        std::vector<Mat> Rs(2), Ts(2), inliers;
        Rs[0] = Mat::eye(3, 3, CV_64F);
        Rs[1] = Mat(R());
        Ts[0] = Mat::zeros(3, 1, CV_64F);
        Ts[1] = Mat(T());
        Mat points(scenePoints(), true);
        return errorOf([&] { refractiveBundleAdjust(images, cameras, std::vector<int>(), Rs, Ts, rvecs, tvecs, points, lengths,
                                                    BundleAdjustOptions(flags)); });
    }

    // The point is not seen in the view.
    void hide(int view, int point)
    {
        for (int camera = 0; camera < 2; camera++)
            images[camera][view].at<Vec2d>(point) = Vec2d(NaN, NaN);
    }

    std::vector<std::vector<Mat> > images;
    std::vector<Vec3d> rvecs, tvecs;
};

TEST(Refract_CalibrationError, of_a_bundle_adjustment)
{
    const std::vector<Vec4d> none, one(1, Vec4d(0, 1, cv::norm(scenePoints()[0] - scenePoints()[1]), 0.01));
    Scene unscaled;
    for (int view = 0; view < 2; view++)
        unscaled.hide(view, 0);
    expectError(CalibrationError::NO_SCALE, Error::StsBadArg, unscaled.error(one, GLASS_FREE_EXTRINSICS));

    Scene loose;
    for (int point = 2; point < 30; point++)
        loose.hide(1, point);
    expectError(CalibrationError::POSE_UNDETERMINED, Error::StsNoConv, loose.error(none, GLASS_FIX_NORMAL), 1);
}

int countErrors(int, const char*, const char*, const char*, int, void* count)
{
    ++*static_cast<int*>(count);
    return 0;
}

// An error callback hears of it once; whoever knows cv::Exception alone catches it whole.
TEST(Refract_CalibrationError, is_raised_as_any_error)
{
    int count = 0;
    cv::redirectError(countErrors, &count);
    std::string what, err;
    int code = 0;
    try { Mono().run(0, 1); }
    catch (const cv::Exception& e) { what = e.what(); err = e.err; code = e.code; }
    cv::redirectError(NULL);
    EXPECT_EQ(1, count);
    EXPECT_EQ(Error::StsNoConv, code);
    EXPECT_EQ("the calibration did not converge in 1 iterations; raise criteria.maxCount, or fix what the views hardly determine",
              err);
    EXPECT_TRUE(contains(what, err));
}

}} // namespace
