// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SHEET_CONSENSUS_HPP
#define REFRACT_TOOLS_SHEET_CONSENSUS_HPP

#include "laser/board_line.hpp"

namespace tools {

/** The plane on which candidates of most images lie, by all pairs of candidates of two images (RANSAC's score, without chance).
@return a unit normal and d; zeros if no two images agree */
cv::Vec4d planeOfMostLines(const std::vector<BoardImage>& images);

//! Pixels, across its line, by which a point is off a plane.
double pixelsOffPlane(const BoardPoint& point, const cv::Vec4d& plane);

//! The direction on a board in camera 1 in which a plane cuts it; zero: they are parallel.
cv::Vec3d intersectionOf(const BoardImage& image, const cv::Vec4d& plane);

} // namespace tools

#endif // REFRACT_TOOLS_SHEET_CONSENSUS_HPP
