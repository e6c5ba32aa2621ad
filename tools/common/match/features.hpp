// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FEATURES_HPP
#define REFRACT_TOOLS_FEATURES_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

/* Features of one image: where, how large, and what they look like. */
namespace tools {

struct Features
{
    std::vector<cv::Point2d> pixels;
    std::vector<double> scales;     //!< half the size that the detector states; of SIFT the standard deviation of the blob, px
    cv::Mat descriptors;            //!< a row each: CV_32F, or CV_8U whose bits are compared

    int size() const { return (int)pixels.size(); }
};

//! Of OpenCV's features2d, the usual one first.
std::vector<std::string> featureNames();

/** @param most the strongest; what has several directions is several features at one place
@param name of featureNames() */
Features featuresOf(const cv::Mat& grey, int most, const std::string& name = "SIFT");

//! Norm by which descriptors of two images are compared.
int normOf(const Features& features);

/* Features that are alike in two images, whatever is known of the cameras. */

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

#endif // REFRACT_TOOLS_FEATURES_HPP
