// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_COARSE_DEPTH_HPP
#define REFRACT_TOOLS_COARSE_DEPTH_HPP

#include "stereo/dense_stereo.hpp"

namespace tools {

/** The first pass: depths of both rectified images, CV_32F of the rig's size, from images of half the size. They stay as they
were if hardly anything was matched. */
void findCoarseDepth(const RectifiedRig& rig, const cv::Mat& image1, const cv::Mat& image2, const MatcherOptions& options,
                     cv::Mat& depth1, cv::Mat& depth2);

} // namespace tools

#endif // REFRACT_TOOLS_COARSE_DEPTH_HPP
