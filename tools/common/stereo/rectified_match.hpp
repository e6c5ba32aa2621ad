// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RECTIFIED_MATCH_HPP
#define REFRACT_TOOLS_RECTIFIED_MATCH_HPP

#include "stereo/dense_stereo.hpp"

namespace tools {

//! Both images of a moment, rectified, and for each new pixel the raw one that it was taken from (CV_32FC2).
struct RectifiedImages
{
    cv::Mat image[2], map[2];
};

/** @param depth1, depth2 as initRefractiveStereoRectifyMap's
@param scale of the new images, beside the rig's */
RectifiedImages rectify(const RectifiedRig& rig, const cv::Mat& image1, const cv::Mat& image2, cv::InputArray depth1,
                        cv::InputArray depth2, double scale);

//! Grey, and turned so that partners lie along the rows: those of a vertical pair lie along the columns.
cv::Mat forMatcher(const RectifiedRig& rig, const cv::Mat& image);
//! The way back.
cv::Mat fromMatcher(const RectifiedRig& rig, const cv::Mat& image);

//! Disparity along the rows, in pixels of the given grey images; NaN: none.
cv::Mat match(const cv::Mat& first, const cv::Mat& second, int minDisparity, int disparities, const MatcherOptions& options);

} // namespace tools

#endif // REFRACT_TOOLS_RECTIFIED_MATCH_HPP
