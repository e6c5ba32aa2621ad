// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHESSBOARD_HPP
#define REFRACT_TOOLS_CHESSBOARD_HPP

#include <opencv2/core.hpp>
#include <vector>

namespace tools {

/** The inner corners of a whole chessboard, known to sub-pixels, row by row from any of its corners; empty if it was not found.
@param other size of the board (the longer side first) if one of another size is in the image; null: nobody asks
@param seconds of processor time for the slower of two detectors */
std::vector<cv::Point2d> detectChessboard(const cv::Mat& grey, cv::Size size, cv::Size* other, int seconds);

//! Light minus dark, summed over the squares between the corners, as seen from the first one: negative if it is dark.
double contrastOfFirstSquare(const std::vector<cv::Point2d>& points, cv::Size size, const cv::Mat& grey);

} // namespace tools

#endif // REFRACT_TOOLS_CHESSBOARD_HPP
