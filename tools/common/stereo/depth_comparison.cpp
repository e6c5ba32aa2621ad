// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/depth_comparison.hpp"
#include "console/failure.hpp"
#include "console/images.hpp"

#include <cmath>
#include <limits>

namespace tools {

namespace {

bool isKnown(float z) { return std::isfinite(z) && z > 0; }

bool isWrong(double z, double truth) { return !(std::abs(z - truth) <= WRONG_DEPTH*truth); }

//! Depth between four pixels, linear in its inverse as a plane is; NaN at borders and edges.
double depthAt(const cv::Mat& depth, const cv::Point2d& p)
{
    const double nowhere = std::numeric_limits<double>::quiet_NaN();
    if (!(p.x >= 0 && p.y >= 0 && p.x < depth.cols - 1 && p.y < depth.rows - 1))
        return nowhere;
    const int x = (int)p.x, y = (int)p.y;
    const float first = depth.at<float>(y, x);
    double sum = 0;
    for (int k = 0; k < 4; k++)
    {
        const float corner = depth.at<float>(y + k/2, x + k % 2);
        if (!isKnown(corner) || isWrong(corner, first))
            return nowhere;
        sum += (k % 2 ? p.x - x : 1 - (p.x - x))*(k/2 ? p.y - y : 1 - (p.y - y))/corner;
    }
    return 1/sum;
}

} // namespace

cv::Mat readTrueDepth(const std::string& path, cv::Size size)
{
    const cv::Mat truth = readImage(path);
    if (truth.type() != CV_32FC1)
        throw Failure("'" + path + "' is no depth map: it must have one channel of 32-bit floating-point numbers, as "
                      "refract_simulate writes");
    requireSize(truth, path, size);
    return truth;
}

DepthComparison compareDepths(const cv::Mat& depth, const cv::Mat& truth)
{
    DepthComparison result;
    double squares = 0;
    for (int y = 0; y < truth.rows; y++)
        for (int x = 0; x < truth.cols; x++)
        {
            const float z = depth.at<float>(y, x), t = truth.at<float>(y, x);
            if (!isKnown(t))
                continue;
            result.known++;
            if (!isKnown(z))
                continue;
            result.matched++;
            if (isWrong(z, t))
                result.wrong++;
            else
                squares += ((double)z - t)*((double)z - t);
        }
    result.rms = std::sqrt(squares/(result.matched - result.wrong));
    return result;
}

void compareSigmas(const Cloud& cloud, const cv::Ptr<cv::refract::RefractiveCamera>& camera, const cv::Mat& truth,
                   DepthComparison& comparison)
{
    const double NORMAL_95 = 1.96;
    std::vector<cv::Point3d> points;
    for (const CloudPoint& point : cloud)
        points.emplace_back(point.position[0], point.position[1], point.position[2]);
    if (points.empty())
        return;
    std::vector<cv::Point2d> pixels;
    cv::refract::refractiveProjectPoints(points, cv::Vec3d(), cv::Vec3d(), camera, pixels);
    for (size_t i = 0; i < cloud.size(); i++)
    {
        const double t = depthAt(truth, pixels[i]), sigma = cloud[i].sigma[2];
        if (!(sigma > 0) || isWrong(points[i].z, t))
            continue;
        comparison.stated++;
        comparison.within += std::abs(points[i].z - t) < NORMAL_95*sigma;
    }
}

} // namespace tools
