// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "test_scene.hpp"

namespace opencv_test { namespace {

using namespace scene;

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

}} // namespace
