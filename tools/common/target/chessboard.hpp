// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHESSBOARD_HPP
#define REFRACT_TOOLS_CHESSBOARD_HPP

#include <opencv2/core.hpp>
#include <algorithm>
#include <vector>

namespace tools {

//! The longer side first.
inline cv::Size longerFirst(cv::Size size) { return cv::Size(std::max(size.width, size.height), std::min(size.width, size.height)); }

/** A piece of a chessboard that is partly out of view, hidden or cut.

Nothing tells which piece of the board it is, so it is put at the grid's first row and column: the points of one image
belong together, those of two images do not. The outermost corners of what is found are left out: they stand where
squares are cut, by the board's edge or by that of the view, and are less exact or wrong.
@param size of the whole board as a detector sees it, corners on cut squares included.
@return size.area() pixels, NaN where a point was not seen; empty if no piece of at least 3 x 3 corners was found. */
std::vector<cv::Point2d> detectPartialChessboard(const cv::Mat& grey, cv::Size size);

//! Whether a chessboard of that size is seen in a small copy of the image.
bool isChessboardLikely(const cv::Mat& grey, cv::Size size);

/** The size of the largest chessboard that is seen in a small copy of the image, whatever it is, in inner corners, the longer side first;
empty: none is. */
cv::Size lookForChessboard(const cv::Mat& grey);

/** The inner corners of a whole chessboard, known to sub-pixels, row by row from any of its corners; empty if it was not found.
@param other size of the board (the longer side first) if one of another size is in the image; null: nobody asks */
std::vector<cv::Point2d> detectChessboard(const cv::Mat& grey, cv::Size size, cv::Size* other);

//! Light minus dark, summed over the squares between the corners, as seen from the first one: negative if it is dark.
double contrastOfFirstSquare(const std::vector<cv::Point2d>& points, cv::Size size, const cv::Mat& grey);

} // namespace tools

#endif // REFRACT_TOOLS_CHESSBOARD_HPP
