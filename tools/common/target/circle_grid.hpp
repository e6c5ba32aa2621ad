// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CIRCLE_GRID_HPP
#define REFRACT_TOOLS_CIRCLE_GRID_HPP

#include <opencv2/core.hpp>
#include <vector>

namespace tools {

//! Where the points of a board are, in units of --square, row by row.
std::vector<cv::Vec2d> gridOf(cv::Size size, bool asymmetric);

/** The images of the centres of dots, dark on light ground or the reverse, NaN where one is missing (up to a quarter of
them); empty if the grid was not found. Some dots may be larger than the others. */
std::vector<cv::Point2d> detectCircleGrid(const cv::Mat& grey, cv::Size size, bool asymmetric);

} // namespace tools

#endif // REFRACT_TOOLS_CIRCLE_GRID_HPP
