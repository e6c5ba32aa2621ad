// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/refine_corners.hpp"

#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <limits>

namespace tools {

void refineCorners(const cv::Mat& grey, std::vector<cv::Point2f>& corners, double reach)
{
    double spacing = std::numeric_limits<double>::max();
    for (size_t i = 0; i < corners.size(); i++)
        for (size_t j = 0; j < i; j++)
            spacing = std::min(spacing, cv::norm(corners[i] - corners[j]));
    const int half = std::max(2, std::min(11, cvFloor(reach*spacing)));
    cv::Mat smooth;
    cv::GaussianBlur(grey, smooth, cv::Size(), std::min(1., std::max(0.3, 0.02*spacing)));
    cv::cornerSubPix(smooth, corners, cv::Size(half, half), cv::Size(-1, -1),
                     cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4));
}

} // namespace tools
