// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DRAWING_HPP
#define REFRACT_TOOLS_DRAWING_HPP

#include "calibrate/calib_file.hpp"
#include <opencv2/core.hpp>
#include <vector>

namespace tools {

//! The i-th of n colours that are well apart; bright enough on grey images.
cv::Scalar colourOf(int i, int n);

//! Anti-aliased, sub-pixel polyline. dash > 0: that many pixels drawn, as many left out.
void drawCurve(cv::Mat& picture, const std::vector<cv::Point2d>& points, const cv::Scalar& colour, double dash = 0.);

/* Points of one raw image, and the curves in another on which their partners are. */

typedef std::vector<cv::Point2d> Curve;

//! Of points of camera 1, in the image of camera 2. @param depth z in the frame of camera 1
std::vector<Curve> curvesOf(const Calibration& pair, const std::vector<cv::Point2d>& points, const cv::Vec2d& depth);

/** Both images side by side; each point, its curve and its partner have one colour.
@param partners may be empty @param ignored the curves where windows are ignored, dashed */
cv::Mat epipolarPicture(const cv::Mat& grey1, const cv::Mat& grey2, const std::vector<cv::Point2d>& points,
                        const std::vector<cv::Point2d>& partners, const std::vector<Curve>& curves, const std::vector<Curve>& ignored);

} // namespace tools

#endif // REFRACT_TOOLS_DRAWING_HPP
