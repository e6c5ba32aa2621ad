// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/coarse_depth.hpp"
#include "stereo/rectified_match.hpp"
#include "stereo/slabs.hpp"

#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

namespace tools {

using cv::Mat;

namespace {

//! How little two rectified images are alike round each pixel of the first, at its disparity; infinite where that is NaN.
Mat unlikeness(const Mat& first, const Mat& second, const Mat& disparity)
{
    Mat columns(disparity.size(), CV_32F), rows(disparity.size(), CV_32F), partners, result;
    for (int y = 0; y < disparity.rows; y++)
        for (int x = 0; x < disparity.cols; x++)
        {
            columns.at<float>(y, x) = (float)x - disparity.at<float>(y, x);
            rows.at<float>(y, x) = (float)y;
        }
    cv::remap(second, partners, columns, rows, cv::INTER_LINEAR);
    cv::absdiff(first, partners, partners);
    cv::blur(partners, result, cv::Size(9, 9));
    result.convertTo(result, CV_32F);
    result.setTo(INFINITY, disparity != disparity);
    return result;
}

//! Disparities of images of half the size; where more than one slab has an answer, that which looks most alike.
Mat coarseDisparity(const RectifiedRig& rig, const Mat& image1, const Mat& image2, const MatcherOptions& options)
{
    const double scale = 0.5;
    const Slabs slabs(rig, scale);
    Mat best, least;
    for (int k = 0; k < slabs.count(); k++)
    {
        const Mat plane(1, 1, CV_64F, cv::Scalar(slabs.depth(k)));
        const RectifiedImages pair = rectify(rig, image1, image2, plane, plane, scale);
        const Mat first = forMatcher(rig, pair.image[0]), second = forMatcher(rig, pair.image[1]);
        const Mat found = match(first, second, slabs.from(k), slabs.disparities(k), options);
        if (slabs.count() == 1)
            return fromMatcher(rig, found);
        const Mat unlike = unlikeness(first, second, found);
        if (best.empty())
        {
            best = Mat(found.size(), CV_32F, NAN);
            least = Mat(found.size(), CV_32F, INFINITY);
        }
        const Mat better = unlike < least;
        found.copyTo(best, better);
        unlike.copyTo(least, better);
    }
    return fromMatcher(rig, best);
}

} // namespace

void findCoarseDepth(const RectifiedRig& rig, const Mat& image1, const Mat& image2, const MatcherOptions& options, Mat& depth1,
                     Mat& depth2)
{
    const Mat coarse = coarseDisparity(rig, image1, image2, options);
    const int FEW = 64;
    if (cv::countNonZero(coarse == coarse) > FEW)
        cv::refract::refractiveRectifiedDepth(coarse, rig.P1, rig.P2, rig.size(), depth1, depth2);
}

} // namespace tools
