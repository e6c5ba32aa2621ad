// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/depth_search.hpp"
#include "console/failure.hpp"
#include "stereo/depth_picture.hpp"

#include <opencv2/imgproc.hpp>
#include <algorithm>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Point3d;

namespace {

const int MOST_DETAILS = 4000;
const double SAME_POINT = 1.5;          // px

} // namespace

std::vector<float> depthsOfFeatures(const Calibration& calibration, const Mat& image1, const Mat& image2)
{
    const Partners partners = findPartners(greyOf(image1, calibration.channel), greyOf(image2, calibration.channel), MOST_DETAILS);
    const std::vector<Point2d> &pixels1 = partners.pixels1, &pixels2 = partners.pixels2;
    std::vector<float> depths;
    if (pixels1.empty())
        return depths;
    const auto &camera1 = calibration.cameras[0].camera, &camera2 = calibration.cameras[1].camera;
    std::vector<Point3d> points, known;
    std::vector<uchar> status;
    cv::refract::triangulateRefractive(camera1, camera2, calibration.extrinsics[1].R, calibration.extrinsics[1].T, pixels1,
                                       pixels2, points, status);
    std::vector<Point2d> known1, known2;
    for (size_t i = 0; i < points.size(); i++)
        if (status[i] == 0 && points[i].z > 0)
        {
            known.push_back(points[i]);
            known1.push_back(pixels1[i]);
            known2.push_back(pixels2[i]);
        }
    if (known.empty())
        return depths;
    std::vector<Point2d> seen1, seen2;
    cv::refract::refractiveProjectPoints(known, cv::Vec3d(), cv::Vec3d(), camera1, seen1);
    cv::refract::refractiveProjectPoints(known, calibration.extrinsics[1].R, calibration.extrinsics[1].T, camera2, seen2);
    for (size_t i = 0; i < known.size(); i++)
        if (cv::norm(seen1[i] - known1[i]) < SAME_POINT && cv::norm(seen2[i] - known2[i]) < SAME_POINT)
            depths.push_back((float)known[i].z);
    std::sort(depths.begin(), depths.end());
    return depths;
}

cv::Vec2d depthRangeOf(const std::vector<float>& depths)
{
    const double rare = 0.02, wider = 0.1;      // what has no details may reach a little farther
    if ((int)depths.size() < MIN_FEATURES)
        throw Failure(cv::format("the depth range of the scene could not be found, as only %d features match in both images: give "
                                 "--depth=NEAR,FAR, and check that the images are of one moment and LEFT is of camera 1",
                                 (int)depths.size()));
    return cv::Vec2d(percentile(depths, rare)/(1 + wider), percentile(depths, 1 - rare)*(1 + wider));
}

} // namespace tools
