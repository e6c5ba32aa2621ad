// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FEATURES_HPP
#define REFRACT_TOOLS_FEATURES_HPP

#include <opencv2/core.hpp>
#include <vector>

/* Features of one image: where, how large, and what they look like. */
namespace tools {

struct Features
{
    std::vector<cv::Point2d> pixels;
    std::vector<double> scales;     //!< standard deviation of the blob, px
    cv::Mat descriptors;            //!< CV_32F, a row each

    int size() const { return (int)pixels.size(); }
};

//! OpenCV's SIFT. @param most the strongest; what has several directions is several features at one place
Features featuresOf(const cv::Mat& grey, int most);

} // namespace tools

#endif // REFRACT_TOOLS_FEATURES_HPP
