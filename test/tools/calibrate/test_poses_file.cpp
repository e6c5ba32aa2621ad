// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Known poses: units, forms of a rotation, what a deviation about each axis is of a rotation vector, what is refused.
#include "calibrate/poses_file.hpp"
#include "scenes.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <opencv2/calib3d.hpp>
#include <fstream>
#include <iostream>

using namespace cv;
using namespace tools;

namespace {

RigData posesOf(const std::string& text, const std::string& unit = "mm", const std::vector<std::string>& views = {"a"})
{
    const TemporaryFolder folder;
    std::ofstream(folder / "poses.csv") << text;
    RigData data;
    for (const std::string& view : views)
    {
        data.views.emplace_back();
        data.views.back().stem = view;
    }
    readPoses(folder / "poses.csv", unit, data);
    return data;
}

} // namespace

TEST_CASE("Poses are read in the units that their columns name", "[poses_file]")
{
    const KnownPose plain = *posesOf("view,rx_deg,ry_deg,rz_deg,tx,ty,tz\nb,0,0,0,0,0,0\na,180,0,90,1,2,3\n").views[0].pose;
    CHECK(norm(plain.rvec - Vec3d(CV_PI, 0, CV_PI/2)) < 1e-12);
    CHECK(plain.tvec == Vec3d(1, 2, 3));
    CHECK(plain.covariance.empty());

    const KnownPose units = *posesOf("view,rx_rad,ry_rad,rz_rad,tx_mm,ty_cm,tz_m,sigma_deg,sigma_mm\na,0.1,0.2,0.3,1,2,3,0,0\n", "cm")
        .views[0].pose;
    CHECK(units.rvec == Vec3d(0.1, 0.2, 0.3));
    CHECK(norm(units.tvec - Vec3d(0.1, 2, 300)) < 1e-12);
    CHECK(units.covariance.empty());            // 0: exact

    Matx33d R;
    Rodrigues(Vec3d(0.3, -0.2, 0.5), R);
    std::string row = "a";
    for (double r : R.val)
        row += format(",%.17g", r);
    const KnownPose matrix = *posesOf("view,r11,r12,r13,r21,r22,r23,r31,r32,r33,tx,ty,tz\n" + row + ",0,0,0\n").views[0].pose;
    CHECK(norm(matrix.rvec - Vec3d(0.3, -0.2, 0.5)) < 1e-12);
}

TEST_CASE("A deviation about each axis is that of the rotation vector, also of a large rotation", "[poses_file]")
{
    scenes::Random random(4100);
    std::cout << "seed " << scenes::seed() << '\n';
    const Vec3d rvec(1.2, -0.8, 2.);
    const KnownPose pose = *posesOf(format("view,rx_rad,ry_rad,rz_rad,tx,ty,tz,sigma_deg,sigma_m\na,%g,%g,%g,1,2,3,0.1,0.002\n",
                                           rvec[0], rvec[1], rvec[2])).views[0].pose;
    REQUIRE(pose.covariance.size() == Size(6, 6));
    CHECK(pose.covariance.at<double>(4, 4) == Approx(4.));             // 2 mm
    const double sigma = 0.1*CV_PI/180;
    Matx33d R, spread;
    Rodrigues(rvec, R);
    const int TRIALS = 20000;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        Matx33d turned;
        Rodrigues(Vec3d(random.normal(sigma), random.normal(sigma), random.normal(sigma)), turned);
        Vec3d r;
        Rodrigues(turned*R, r);
        spread += (r - rvec)*(r - rvec).t()*(1./TRIALS);
    }
    const Mat stated = pose.covariance(Rect(0, 0, 3, 3));
    CHECK(norm(Mat(spread) - stated) < 0.05*norm(stated));
    CHECK(norm(stated - Mat(Mat::eye(3, 3, CV_64F)*sigma*sigma)) > 0.2*norm(stated));        // it is not simply that
}

TEST_CASE("Poses that are none are refused with file and line", "[poses_file]")
{
    using Catch::Contains;
    const std::string heading = "view,rx_deg,ry_deg,rz_deg,tx,ty,tz";
    CHECK_THROWS_WITH(posesOf(heading + "\nb,0,0,0,0,0,0\n"), Contains("no pose of view") && Contains("'a'"));
    CHECK_THROWS_WITH(posesOf(heading + "\na,0,0,0,0,0,0\na,0,0,0,0,0,0\n"), Contains("line 3") && Contains("already"));
    CHECK_THROWS_WITH(posesOf("view,rx_deg,ry_deg,rz_deg,tx,ty\na,0,0,0,0,0\n"), Contains("tz"));
    CHECK_THROWS_WITH(posesOf("view,tx,ty,tz\na,0,0,0\n"), Contains("rotations"));
    CHECK_THROWS_WITH(posesOf(heading + ",sigma\na,0,0,0,0,0,0,1\n"), Contains("sigma_deg"));
    CHECK_THROWS_WITH(posesOf(heading + ",sigma_deg,sigma\na,0,0,0,0,0,0,-1,1\n"), Contains("line 2") && Contains("not below 0"));
    CHECK_THROWS_WITH(posesOf(heading + ",sigma_deg,sigma\na,0,0,0,0,0,0,0,1\n"), Contains("line 2") && Contains("both"));
    CHECK_THROWS_WITH(posesOf("view,r11,r12,r13,r21,r22,r23,r32,r33,tx,ty,tz\na,1,0,0,0,1,0,0,1,0,0,0\n"),
                      Contains("no column 'r31'"));
    for (const char* matrix : {"1,0,0,0,1,0,0,0,2", "1e200,1e200,0,-1e200,1e200,0,0,0,1"})       // squares that are no numbers
        CHECK_THROWS_WITH(posesOf(std::string("view,r11,r12,r13,r21,r22,r23,r31,r32,r33,tx,ty,tz\na,") + matrix + ",0,0,0\n"),
                          Contains("line 2") && Contains("no rotation"));
}
