// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/raw_depth.hpp"

#include <algorithm>
#include <cmath>

namespace tools {

using cv::Mat;
using cv::Matx33d;
using cv::Point;
using cv::Size;
using cv::Vec3d;

namespace {

const float NONE = std::numeric_limits<float>::quiet_NaN();

//! The surface's depth (rectified frame) at a place of the new image.
double surfaceAt(const Mat& depth, const cv::Point2d& p)
{
    if (depth.total() == 1)
        return depth.at<double>(0);
    const int x = std::clamp(cvRound(p.x), 0, depth.cols - 1), y = std::clamp(cvRound(p.y), 0, depth.rows - 1);
    return depth.at<float>(y, x);
}

//! z between four pixels, if they are of one surface; else of the nearest.
float interpolated(const Mat& points, const cv::Point2d& p)
{
    const double ONE_SURFACE = 0.02;
    const Point nearest(cvRound(p.x), cvRound(p.y));
    if (!cv::Rect(Point(), points.size()).contains(nearest))
        return NONE;
    const float z = points.at<cv::Vec3f>(nearest)[2];
    const int x = cvFloor(p.x), y = cvFloor(p.y);
    if (!(z == z) || x < 0 || y < 0 || x + 1 >= points.cols || y + 1 >= points.rows)
        return z;
    double sum = 0;
    for (int k = 0; k < 4; k++)
    {
        const float corner = points.at<cv::Vec3f>(y + k/2, x + k % 2)[2];
        if (!(std::abs(corner - z) < ONE_SURFACE*z))
            return z;
        sum += (k % 2 ? p.x - x : 1 - (p.x - x))*(k/2 ? p.y - y : 1 - (p.y - y))/corner;
    }
    return (float)(1/sum);
}

} // namespace

Mat depthOfRawPixels(const RectifiedRig& rig, const DenseStereo& stereo)
{
    const int STEPS = 3;        // the surface at the place that the surface at the last place leads to
    const Size size = rig.size();
    const Matx33d turn(rig.R1.ptr<double>()), K(rig.P1.colRange(0, 3).clone().ptr<double>());
    const Vec3d centre = rig.centre();
    Mat depth(size, CV_32F);
    cv::parallel_for_(cv::Range(0, size.height), [&](const cv::Range& range) {
        std::vector<cv::Point2d> pixels(size.width);
        std::vector<Vec3d> origins, directions;
        for (int y = range.start; y < range.end; y++)
        {
            for (int x = 0; x < size.width; x++)
                pixels[x] = cv::Point2d(x, y);
            cv::refract::refractiveUnprojectPoints(pixels, origins, directions, rig.calibration().cameras[0].camera);
            for (int x = 0; x < size.width; x++)
            {
                const Vec3d o = turn*origins[x], d = turn*directions[x];
                double z = rig.planeDepth();
                cv::Point2d p;
                for (int step = 0; step < STEPS; step++)
                {
                    const Vec3d X = o + (z - o[2])/d[2]*d - centre, q = K*X;
                    p = cv::Point2d(q[0]/q[2], q[1]/q[2]);
                    if (!(std::abs(p.x) < 1e6 && std::abs(p.y) < 1e6))
                        break;
                    z = surfaceAt(stereo.depth1, p);
                }
                depth.at<float>(y, x) = std::abs(p.x) < 1e6 && std::abs(p.y) < 1e6 ? interpolated(stereo.points, p) : NONE;
            }
        }
    });
    return depth;
}

} // namespace tools
