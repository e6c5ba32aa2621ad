// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/epipolar_check.hpp"

#include <cmath>

namespace tools {

using cv::Mat;
using cv::Vec2f;
using cv::Vec3f;

namespace {

const double MOST = 1;      // px between a raw pixel and the other's epipolar curve

//! The raw pixel between two places of a map; NaN where it has none.
Vec2f between(const Vec2f& a, const Vec2f& b, float part)
{
    if (a == Vec2f(-1, -1) || b == Vec2f(-1, -1))
        return Vec2f(NAN, NAN);
    return a + part*(b - a);
}

//! Raw pixel of camera 2 of the partner of (x, y).
Vec2f partnerOf(const Mat& map, bool vertical, int x, int y, float disparity)
{
    const float place = (float)(vertical ? y : x) - disparity;
    const int last = (vertical ? map.rows : map.cols) - 1;
    if (!(place >= 0 && place <= (float)last))
        return Vec2f(NAN, NAN);
    const int first = cvFloor(place), second = std::min(first + 1, last);
    return vertical ? between(map.at<Vec2f>(first, x), map.at<Vec2f>(second, x), place - (float)first)
                    : between(map.at<Vec2f>(y, first), map.at<Vec2f>(y, second), place - (float)first);
}

} // namespace

void removeInconsistentPoints(const RectifiedRig& rig, const RectifiedImages& rectified, const Mat& disparity, Mat& points)
{
    const Calibration& c = rig.calibration();
    cv::parallel_for_(cv::Range(0, points.rows), [&](const cv::Range& range) {
        Mat seen1, seen2;
        for (int y = range.start; y < range.end; y++)
        {
            const Mat row = points.row(y);
            cv::refract::refractiveProjectPoints(row, cv::Vec3d(), cv::Vec3d(), c.cameras[0].camera, seen1);
            cv::refract::refractiveProjectPoints(row, c.extrinsics[1].R, c.extrinsics[1].T, c.cameras[1].camera, seen2);
            for (int x = 0; x < points.cols; x++)
            {
                const Vec2f raw1 = rectified.map[0].at<Vec2f>(y, x);
                const Vec2f raw2 = partnerOf(rectified.map[1], rig.vertical(), x, y, disparity.at<float>(y, x));
                // The most likely point is in the middle: each pixel is off by half of what they miss each other by.
                const double miss = std::sqrt(2*(norm(seen1.at<Vec2f>(x) - raw1, cv::NORM_L2SQR)
                                                 + norm(seen2.at<Vec2f>(x) - raw2, cv::NORM_L2SQR)));
                if (!(miss <= MOST))
                    points.at<Vec3f>(y, x) = Vec3f(NAN, NAN, NAN);
            }
        }
    });
}

} // namespace tools
