// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "test_scene.hpp"

// Compiled in place of test_calibration.cpp where there is no Ceres (cmake/ceres.cmake).
#ifdef REFRACT_WITHOUT_CERES

namespace opencv_test { namespace {

using namespace scene;

TEST(Refract_WithoutCeres, calibrators_say_what_is_missing)
{
    GlassWindow window = window1();
    std::vector<Vec3d> rvecs, tvecs;
    EXPECT_REFUSED(calibrateGlass(boards(), views(bare1()), views(camera1()), K1(), D1(), window, rvecs, tvecs),
                   "calibrateGlass needs the library Ceres");
    EXPECT_REFUSED(calibrateGlass(boards(), views(bare1()), views(camera1()), camera1(), rvecs, tvecs), "REFRACT_WITH_CERES=ON");
    Mat rotation(R()), translation(T());
    EXPECT_REFUSED(stereoCalibrateGlass(boards(), views(bare1()), views(camera1()), views(bare2(), true),
                                        views(camera2(), true), camera1(), camera2(), rotation, translation, rvecs, tvecs),
                   "stereoCalibrateGlass needs the library Ceres");
}

TEST(Refract_WithoutCeres, the_code_is_not_implemented)
{
    const std::vector<Ptr<RefractiveCamera> > cameras(1, camera1());
    const std::vector<std::vector<Mat> > none;
    std::vector<Mat> Rs, Ts, rvecs, tvecs;
    std::vector<Point3d> points;
    int rig = 0, bundle = 0;
    EXPECT_REFUSED(selectLensCoefficients(boards(), none, none, cameras, std::vector<int>(), noArray(), noArray()),
                   "selectLensCoefficients needs the library Ceres");
    try { calibrateGlassRig(boards(), none, none, cameras, std::vector<int>(), Rs, Ts, rvecs, tvecs); }
    catch (const cv::Exception& e) { rig = e.code; }
    EXPECT_REFUSED(calibrateGlassRig(boards(), none, none, cameras, std::vector<int>(), Rs, Ts, rvecs, tvecs, GlassRigOptions()),
                   "calibrateGlassRig needs the library Ceres");
    EXPECT_REFUSED(refractiveBundleAdjust(none, cameras, std::vector<int>(), Rs, Ts, rvecs, tvecs, points, noArray(),
                                          BundleAdjustOptions()), "refractiveBundleAdjust needs the library Ceres");
    try { refractiveBundleAdjust(views(camera1()), cameras, std::vector<int>(), Rs, Ts, points, noArray()); }
    catch (const cv::Exception& e) { bundle = e.code; }
    EXPECT_EQ(int(Error::StsNotImplemented), rig);
    EXPECT_EQ(int(Error::StsNotImplemented), bundle);
}

}} // namespace

#endif // REFRACT_WITHOUT_CERES
