// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_DEPTH_COMPARISON_HPP
#define REFRACT_TEST_DEPTH_COMPARISON_HPP

#include <opencv2/imgcodecs.hpp>
#include <opencv2/refract.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

/* Measured depth against a known one. */

struct DepthComparison
{
    int known = 0;          //!< pixels with a true depth
    int matched = 0;        //!< those of them with a measured one, too
    int wrong = 0;          //!< those of them that are off by more than WRONG_DEPTH
    double rms = 0;         //!< error of those that are not wrong; NaN if there are none
    int stated = 0;         //!< points that state a sigma and are not wrong
    int within = 0;         //!< those of them whose error is less than 1.96 sigma
};

const double WRONG_DEPTH = 0.02;        //!< share of the true depth

inline bool isKnownDepth(float z) { return std::isfinite(z) && z > 0; }

inline bool isWrongDepth(double z, double truth) { return !(std::abs(z - truth) <= WRONG_DEPTH*truth); }

//! @param depth, truth CV_32F; NaN, infinite, 0 and less: unknown
inline DepthComparison compareDepths(const cv::Mat& depth, const cv::Mat& truth)
{
    DepthComparison result;
    double squares = 0;
    for (int y = 0; y < truth.rows; y++)
        for (int x = 0; x < truth.cols; x++)
        {
            const float z = depth.at<float>(y, x), t = truth.at<float>(y, x);
            if (!isKnownDepth(t))
                continue;
            result.known++;
            if (!isKnownDepth(z))
                continue;
            result.matched++;
            if (isWrongDepth(z, t))
                result.wrong++;
            else
                squares += ((double)z - t)*((double)z - t);
        }
    result.rms = std::sqrt(squares/(result.matched - result.wrong));
    return result;
}

//! Depth between four pixels, linear in its inverse as a plane is; NaN at borders and edges.
inline double depthBetweenPixels(const cv::Mat& depth, const cv::Point2d& p)
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
        if (!isKnownDepth(corner) || isWrongDepth(corner, first))
            return nowhere;
        sum += (k % 2 ? p.x - x : 1 - (p.x - x))*(k/2 ? p.y - y : 1 - (p.y - y))/corner;
    }
    return 1/sum;
}

//! A point of a cloud, and one standard deviation of its z.
struct MeasuredPoint
{
    cv::Point3d point;
    double sigmaZ;
};

/** Adds stated and within: where camera 1 sees each point, truth is looked up, between pixels that are of one surface. The
points of a cloud are compared, as a depth map has no sigma. */
inline void compareSigmas(const std::vector<MeasuredPoint>& cloud, const cv::Ptr<cv::refract::RefractiveCamera>& camera,
                          const cv::Mat& truth, DepthComparison& comparison)
{
    const double NORMAL_95 = 1.96;
    std::vector<cv::Point3d> points;
    for (const MeasuredPoint& measured : cloud)
        points.push_back(measured.point);
    if (points.empty())
        return;
    std::vector<cv::Point2d> pixels;
    cv::refract::refractiveProjectPoints(points, cv::Vec3d(), cv::Vec3d(), camera, pixels);
    for (size_t i = 0; i < cloud.size(); i++)
    {
        const double t = depthBetweenPixels(truth, pixels[i]), sigma = cloud[i].sigmaZ;
        if (!(sigma > 0) || isWrongDepth(points[i].z, t))
            continue;
        comparison.stated++;
        comparison.within += std::abs(points[i].z - t) < NORMAL_95*sigma;
    }
}

//! As refract_stereo writes it: each vertex x, y, z, three bytes of colour, sx, sy, sz.
inline std::vector<MeasuredPoint> readCloud(const std::string& path)
{
    std::ifstream in(path, std::ios::binary);
    std::string line;
    while (std::getline(in, line) && line != "end_header") {}
    std::vector<MeasuredPoint> cloud;
    char vertex[27];
    while (in.read(vertex, sizeof vertex))
    {
        float position[3], sigma[3];
        std::memcpy(position, vertex, sizeof position);
        std::memcpy(sigma, vertex + 15, sizeof sigma);
        cloud.push_back({{position[0], position[1], position[2]}, sigma[2]});
    }
    return cloud;
}

//! Of what refract_stereo wrote with a calibration. @param truth as refract_simulate writes it
inline DepthComparison compareWithTruth(const std::string& calibration, const std::string& depthMap, const std::string& cloud,
                                        const std::string& truth)
{
    const cv::Mat known = cv::imread(truth, cv::IMREAD_UNCHANGED);
    DepthComparison comparison = compareDepths(cv::imread(depthMap, cv::IMREAD_UNCHANGED), known);
    std::vector<cv::Ptr<cv::refract::RefractiveCamera>> cameras;
    std::vector<cv::Mat> R, T;
    cv::refract::readRig(calibration, cameras, R, T);
    compareSigmas(readCloud(cloud), cameras[0], known, comparison);
    return comparison;
}

#endif // REFRACT_TEST_DEPTH_COMPARISON_HPP
