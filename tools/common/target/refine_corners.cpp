// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/refine_corners.hpp"

#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <limits>

namespace tools {

namespace {

const int LEAST_HALF = 2;
const int GRADIENT = 1;                 // pixels beyond
const double UNLIKE = 0.3;              // of the contrast: such a difference is not noise
const double FEW = 0.2;                 // of a ring's pixels: edges that are not quite where their opposites are

/* A corner looks the same turned by half a circle, and no affine map changes that; what else may be there, as the end of a board
that is cut by the border of what is seen, or a finger, does not. It begins at some distance, so rings are looked at.
@param half to that distance */
bool isPointSymmetric(const cv::Mat& grey, const cv::Point2f& corner, int half)
{
    cv::Mat patch, turned;
    cv::getRectSubPix(grey, cv::Size(2*half + 1, 2*half + 1), corner, patch);
    cv::flip(patch, turned, -1);
    double low, high;
    cv::minMaxLoc(patch, &low, &high);
    cv::absdiff(patch, turned, turned);
    const cv::Mat different = turned > UNLIKE*(high - low);
    int within = 0;                     // the rings inside
    for (int ring = 0; ring <= half; ring++)
    {
        const int side = 2*ring + 1;
        const int all = cv::countNonZero(different(cv::Rect(half - ring, half - ring, side, side)));
        if (ring > LEAST_HALF && all - within > FEW*8*ring)
            return false;
        within = all;
    }
    return true;
}

void refine(const cv::Mat& smooth, std::vector<cv::Point2f>& corners, int half)
{
    cv::cornerSubPix(smooth, corners, cv::Size(half, half), cv::Size(-1, -1),
                     cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4));
}

} // namespace

void refineCorners(const cv::Mat& grey, std::vector<cv::Point2f>& corners, double reach)
{
    double spacing = std::numeric_limits<double>::max();
    for (size_t i = 0; i < corners.size(); i++)
        for (size_t j = 0; j < i; j++)
            spacing = std::min(spacing, cv::norm(corners[i] - corners[j]));
    const int half = std::max(LEAST_HALF, std::min(11, cvFloor(reach*spacing)));
    cv::Mat smooth;
    cv::GaussianBlur(grey, smooth, cv::Size(), std::min(1., std::max(0.3, 0.02*spacing)));
    const std::vector<cv::Point2f> found = corners;
    refine(smooth, corners, half);
    for (size_t i = 0; i < corners.size(); i++)
    {
        std::vector<cv::Point2f> one = {corners[i]};
        int of = half;
        while (of >= LEAST_HALF && !isPointSymmetric(smooth, one[0], of + GRADIENT))
            if (--of >= LEAST_HALF)
            {
                one[0] = found[i];
                refine(smooth, one, of);
            }
        if (of >= LEAST_HALF)           // else a robust fit may leave it out
            corners[i] = one[0];
    }
}

} // namespace tools
