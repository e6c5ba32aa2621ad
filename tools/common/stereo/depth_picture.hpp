// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DEPTH_PICTURE_HPP
#define REFRACT_TOOLS_DEPTH_PICTURE_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

/* A depth map as a picture. */
namespace tools {

/* A rectified pair as pictures, to look at and for other matchers. */

//! Side by side with horizontal lines, on which partners lie; one above the other with vertical lines for a vertical rig.
cv::Mat sideBySide(const cv::Mat& rectified1, const cv::Mat& rectified2, bool vertical);

//! What writeRectified() writes, in its order.
std::vector<std::string> rectifiedFiles(const std::string& prefix);

/** PREFIXleft.png, PREFIXright.png, PREFIXpair.png (sideBySide) and PREFIXdisparity.tiff.
@param disparity CV_32F, NaN: none */
void writeRectified(const std::string& prefix, const cv::Mat& rectified1, const cv::Mat& rectified2, const cv::Mat& disparity,
                    bool vertical);

//! The depths that are neither NaN nor infinite, in ascending order.
std::vector<float> sortedDepths(const cv::Mat& depth);

//! Round numbers (1, 2 or 5 times a power of ten apart) in a range, about as many as asked for.
std::vector<double> ticksOf(double from, double to, int about);

/** Near is bright; black: unknown. At the right a scale bar with numbers, of what is found but for the outermost percent at
either end; what lies there has the colour of the end.
@param depth CV_32F
@param unit of the numbers, empty: unknown */
cv::Mat depthPicture(const cv::Mat& depth, const std::string& unit);

} // namespace tools

#endif // REFRACT_TOOLS_DEPTH_PICTURE_HPP
