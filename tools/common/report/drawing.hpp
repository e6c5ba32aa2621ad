// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DRAWING_HPP
#define REFRACT_TOOLS_DRAWING_HPP

#include <opencv2/core.hpp>
#include <vector>

namespace tools {

//! The i-th of n colours that are well apart; bright enough on grey images.
cv::Scalar colourOf(int i, int n);

//! Anti-aliased, sub-pixel polyline. dash > 0: that many pixels drawn, as many left out.
void drawCurve(cv::Mat& picture, const std::vector<cv::Point2d>& points, const cv::Scalar& colour, double dash = 0.);

//! Small ring with the point in its middle free.
void drawRing(cv::Mat& picture, const cv::Point2d& centre, const cv::Scalar& colour, double radius = 6.);

//! A line of text on a dark ground; the corner is its lower left.
void drawCaption(cv::Mat& picture, const std::string& text, const cv::Point& corner);

} // namespace tools

#endif // REFRACT_TOOLS_DRAWING_HPP
