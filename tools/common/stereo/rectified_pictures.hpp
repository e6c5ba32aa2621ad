// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RECTIFIED_PICTURES_HPP
#define REFRACT_TOOLS_RECTIFIED_PICTURES_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

/* A rectified pair as pictures, to look at and for other matchers. */
namespace tools {

//! Side by side with horizontal lines, on which partners lie; one above the other with vertical lines for a vertical rig.
cv::Mat sideBySide(const cv::Mat& rectified1, const cv::Mat& rectified2, bool vertical);

//! What writeRectified() writes, in its order.
std::vector<std::string> rectifiedFiles(const std::string& prefix);

/** PREFIXleft.png, PREFIXright.png, PREFIXpair.png (sideBySide) and PREFIXdisparity.tiff.
@param disparity CV_32F, NaN: none */
void writeRectified(const std::string& prefix, const cv::Mat& rectified1, const cv::Mat& rectified2, const cv::Mat& disparity,
                    bool vertical);

} // namespace tools

#endif // REFRACT_TOOLS_RECTIFIED_PICTURES_HPP
