// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Poses of targets in survey coordinates: the same answers as with the origin at the target.
#include "far_origins.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

TEST_CASE("Poses of targets with a far origin are those of targets with a near one", "[pnp][far_origin]")
{
    CAPTURE(seed());
    Random random(8800);
    const Ptr<RefractiveCamera> camera = paperCamera(GlassWindow(Vec3d(0.1, 0.05, 1), 12, 1.5, 20, 1.333));
    std::vector<Point3d> object;
    for (int i = 0; i < 20; i++)
        object.push_back({ random.uniform(-120, 120), random.uniform(-80, 80), random.uniform(-40, 40) });
    std::vector<Point2d> pixels;
    refractiveProjectPoints(object, Vec3d(0.4, -1.1, 0.8), Vec3d(10, -20, 600), camera, pixels);
    for (Point2d& p : pixels)
        p += Point2d(random.normal(0.1), random.normal(0.1));
    Mat rvec, tvec, error, covariance;
    REQUIRE(refractiveSolvePnP(object, pixels, camera, rvec, tvec, false, error, covariance, 0.1));
    for (double offset : OFFSETS)
    {
        CAPTURE(offset);
        const Vec3d o = originAt(offset);
        const std::vector<Point3d> moved = movedBy(object, o);
        const double limit = 1e-7 + 100*ROUNDING*offset/600;
        Mat r, t, e, C;
        REQUIRE(refractiveSolvePnP(moved, pixels, camera, r, t, false, e, C, 0.1));
        CHECK(poseDifference(r, t, o, rvec, tvec) < limit);
        CHECK(e.at<double>(0) == Approx(error.at<double>(0)).epsilon(1e-6).margin(ROUNDING*offset));
        for (int i = 0; i < 3; i++)
            CHECK(C.at<double>(i, i) == Approx(covariance.at<double>(i, i)).epsilon(1e-4));
        // Of the target's points: what is far off cancels.
        Matx<double, 3, 6> byPose = Matx<double, 3, 6>::zeros();
        Mat R, dR;
        Rodrigues(r, R, dR);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                byPose(k, i) = dR.row(i).reshape(1, 3).row(k).dot(Mat(o).t());
        for (int k = 0; k < 3; k++)
            byPose(k, 3 + k) = 1;
        if (offset <= 1e6)
        {
            const Mat ofOrigin = Mat(byPose)*C*Mat(byPose).t();
            CHECK(norm(ofOrigin, covariance(Rect(3, 3, 3, 3))) < 1e-3*norm(covariance(Rect(3, 3, 3, 3))));
        }
        Mat guessR = r.clone(), guessT = t.clone();
        REQUIRE(refractiveSolvePnP(moved, pixels, camera, guessR, guessT, true));
        CHECK(poseDifference(guessR, guessT, o, rvec, tvec) < limit);
        std::vector<Mat> rs, ts;
        REQUIRE(refractiveSolvePnPGeneric(moved, pixels, camera, rs, ts) >= 1);
        CHECK(poseDifference(rs[0], ts[0], o, rvec, tvec) < limit);

        std::vector<Point2d> some = pixels;
        some[3] += Point2d(40, -30);
        std::vector<int> inliers;
        Mat ransacC;
        REQUIRE(refractiveSolvePnPRansac(moved, some, camera, r, t, false, 100, 1.f, 0.99, inliers, ransacC, 0.1));
        CHECK(inliers.size() == 19);
        CHECK(poseDifference(r, t, o, rvec, tvec) < 0.01);
        CHECK(ransacC.at<double>(0, 0) == Approx(covariance.at<double>(0, 0)).epsilon(0.3));
        const std::vector<Point3d> three(moved.begin(), moved.begin() + 4), nearThree(object.begin(), object.begin() + 4);
        const std::vector<Point2d> their(pixels.begin(), pixels.begin() + 4);
        std::vector<Mat> rs3, ts3, nearRs, nearTs;
        REQUIRE(refractiveSolveP3P(three, their, camera, rs3, ts3) == refractiveSolveP3P(nearThree, their, camera, nearRs, nearTs));
        CHECK(poseDifference(rs3[0], ts3[0], o, nearRs[0], nearTs[0]) < 1e-6 + 1e4*ROUNDING*offset);
    }
}
