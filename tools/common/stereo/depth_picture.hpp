// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DEPTH_PICTURE_HPP
#define REFRACT_TOOLS_DEPTH_PICTURE_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

/* A depth map as a picture. */
namespace tools {

//! The depths that are neither NaN nor infinite, in ascending order.
std::vector<float> sortedDepths(const cv::Mat& depth);

//! The depth below which that share of sorted ones is.
double percentile(const std::vector<float>& sorted, double share);

//! Round numbers (1, 2 or 5 times a power of ten apart) in a range, about as many as asked for.
std::vector<double> ticksOf(double from, double to, int about);

/** Near is bright; black: unknown. At the right a scale bar with numbers, of what is found but for the outermost percent at
either end; what lies there has the colour of the end.
@param depth CV_32F
@param unit of the numbers, empty: unknown */
cv::Mat depthPicture(const cv::Mat& depth, const std::string& unit);

} // namespace tools

#endif // REFRACT_TOOLS_DEPTH_PICTURE_HPP
