// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Matches that no point explains.
#include "scene_pair.hpp"
#include "stereo/match_support.hpp"
#include <catch2/catch.hpp>

using namespace tools;
using cv::Mat;

TEST_CASE("Points whose raw pixels miss each other's epipolar curve are taken away, the others stay", "[tools][stereo]")
{
    const ScenePair scene;
    const RectifiedRig rig(scene.rig, cv::Vec2d(430, 1250));
    const double z = 700, c = rig.centre()[2];
    const double disparity = rig.shift() + (rig.depthOf(rig.shift() + 1) - c)/(z - c);
    const std::vector<double> plane = {z};
    const RectifiedImages rectified = rectify(rig, scene.left, scene.right, plane, plane, 1);
    const auto& cameras = scene.rig.cameras;
    const int x = rig.size().width/2, y = rig.size().height/2, whole = cvRound(disparity);
    const Mat disparities(rig.size(), CV_32F, cv::Scalar(whole));
    for (double off : {0., 0.7, -0.7, 1.5, -1.5, 30.})
    {
        RectifiedImages moved = rectified;
        moved.map[1] = rectified.map[1].clone();
        moved.map[1].at<cv::Vec2f>(y, x - whole)[1] += (float)off;     // the partner's raw pixel, across its row
        const std::vector<cv::Point2f> raw1 = {moved.map[0].at<cv::Point2f>(y, x)}, raw2 = {moved.map[1].at<cv::Point2f>(y, x - whole)};
        std::vector<cv::Point3f> seen;
        cv::refract::triangulateRefractive(cameras[0].camera, cameras[1].camera, scene.rig.extrinsics[1].R, scene.rig.extrinsics[1].t,
                                           raw1, raw2, seen);
        Mat points(rig.size(), CV_32FC3, cv::Scalar::all(NAN));
        points.at<cv::Point3f>(y, x) = seen[0];
        removeInconsistentPoints(rig, moved, disparities, points);
        INFO("off by " << off);
        CHECK(cv::countNonZero(points.reshape(1) == points.reshape(1)) == (std::abs(off) < 1 ? 3 : 0));
    }
}
