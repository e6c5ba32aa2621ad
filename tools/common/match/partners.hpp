// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PARTNERS_HPP
#define REFRACT_TOOLS_PARTNERS_HPP

#include <opencv2/core.hpp>
#include <vector>

/* Features that are alike in two images, whatever is known of the cameras. */
namespace tools {

//! As few tell something of a pair.
const int MIN_FEATURES = 30;

//! Pixels of features that choose each other.
struct Partners
{
    std::vector<cv::Point2d> pixels1, pixels2;
};
//! @param mostFeatures of each image, the strongest
Partners findPartners(const cv::Mat& grey1, const cv::Mat& grey2, int mostFeatures);

} // namespace tools

#endif // REFRACT_TOOLS_PARTNERS_HPP
