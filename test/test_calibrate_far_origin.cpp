// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Calibrations from targets in survey coordinates: the same answers as with the origin at the target.
#include "far_origins.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

TEST_CASE("Calibrations from targets with a far origin are those from targets with a near one", "[calibrate][far_origin]")
{
    CAPTURE(seed());
    const bool isPaired = GENERATE(true, false);
    Random random(8810);
    const RigTruth truth = makeRig(1, { 0 }, isPaired ? 1. : 1.333);
    const RigScene scene = makeRigScene(truth, 6, random, 0.1);
    const auto calibrate = [&](const Vec3d& o, Mat& jacobian, std::vector<Mat>& rvecs, std::vector<Mat>& tvecs, Mat& deviations)
    {
        RigCall call(truth, scene, isPaired);
        for (std::vector<Point3d>& points : call.object)
            points = movedBy(points, o);
        Mat covariance, errors;
        const std::vector<Mat> none;
        calibrateGlass(call.object, isPaired ? call.direct[0] : none, call.refracted[0], call.cameras[0], rvecs, tvecs, deviations,
                       covariance, errors, jacobian, GLASS_FREE_INTRINSICS);
        return call.cameras[0];
    };
    Mat jacobian, deviations;
    std::vector<Mat> rvecs, tvecs;
    const Ptr<RefractiveCamera> expected = calibrate(Vec3d(), jacobian, rvecs, tvecs, deviations);
    for (double offset : OFFSETS)
    {
        CAPTURE(isPaired, offset);
        const Vec3d o = originAt(offset);
        Mat J, std;
        std::vector<Mat> rs, ts;
        const Ptr<RefractiveCamera> found = calibrate(o, J, rs, ts, std);
        const double rounding = 1e3*ROUNDING*offset;
        CHECK(norm(found->window().normal - expected->window().normal) < 1e-3*deviations.at<double>(8) + rounding);
        const double f = found->cameraMatrix().at<double>(0, 0) - expected->cameraMatrix().at<double>(0, 0);
        CHECK(std::abs(f) < 1e-3*deviations.at<double>(0) + 1e3*rounding);
        for (int i = 0; i < std.rows; i++)
            CHECK(std.at<double>(i) == Approx(deviations.at<double>(i)).epsilon(1e-3).margin(1e-9));
        for (size_t view = 0; view < rs.size(); view++)
            CHECK(poseDifference(rs[view], ts[view], o, rvecs[view], tvecs[view]) < 1e-5 + rounding);
        if (offset > 1e6)
            continue;
        Mat byProjection, status;
        std::vector<Point2d> pixels;
        refractiveProjectPoints(movedBy(scene.object[0], o), rs[0], ts[0], found, pixels, status, byProjection);
        const int n = (int)scene.object[0].size(), rows = isPaired ? 2*n : 0, P = (int)found->parameterNames().size();
        const Mat ofView = J.rowRange(rows, rows + 2*n).colRange(P, P + 6);
        CHECK(norm(ofView, byProjection.colRange(0, 6)) < 1e-6*norm(ofView));
    }
}

TEST_CASE("Known poses of targets with a far origin count as those of targets with a near one", "[known][far_origin]")
{
    CAPTURE(seed());
    Random random(8820);
    const RigTruth truth = makeRig(1, { 0 }, 1.333);
    const RigScene scene = makeRigScene(truth, 5, random, 0.1);
    const Vec3d o = originAt(1e5);
    const auto run = [&](bool isFar, bool isExact)
    {
        RigCall call(truth, scene, false);
        for (size_t view = 0; view < scene.object.size(); view++)
        {
            const Matx33d R = matrixOf(Mat(scene.rvecs[view]));
            Mat C = Mat::eye(6, 6, CV_64F)*1e-6, D, dR;
            C(Rect(3, 3, 3, 3)) *= 1e4;
            Vec3d t = scene.tvecs[view];
            if (isFar)
            {
                call.object[view] = movedBy(call.object[view], o);
                t -= R*o;
                Rodrigues(scene.rvecs[view], D, dR);
                Mat A = Mat::eye(6, 6, CV_64F);
                for (int i = 0; i < 3; i++)
                    for (int k = 0; k < 3; k++)
                        A.at<double>(3 + k, i) = -dR.row(i).reshape(1, 3).row(k).dot(Mat(o).t());
                C = A*C*A.t();
                C = 0.5*(C + C.t());
            }
            call.rvecs.push_back(Mat(scene.rvecs[view], true));
            call.tvecs.push_back(Mat(t, true));
            call.poseCovariances.push_back(isExact ? Mat() : C);
        }
        call.run(GLASS_USE_POSES);
        return call;
    };
    for (bool isExact : { true, false })
    {
        CAPTURE(isExact);
        const RigCall expected = run(false, isExact), found = run(true, isExact);
        CHECK(norm(found.cameras[0]->window().normal - expected.cameras[0]->window().normal) < 1e-2*expected.stdDeviations.at<double>(8));
        for (int i = 8; i < 11; i++)
            CHECK(found.stdDeviations.at<double>(i) == Approx(expected.stdDeviations.at<double>(i)).epsilon(1e-2));
    }
}
