// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_APRIL_GRID_HPP
#define REFRACT_TOOLS_APRIL_GRID_HPP

#include <opencv2/core.hpp>
#include <vector>

/* Kalibr's board: rows of AprilTags (36h11, a dark border of two modules) with dark squares between their corners. The first tag is at the
lower left, numbers go to the right and then up. Points are the tags' corners, row by row from the upper left. */
namespace tools {

//! Tags there are to make a board of.
const int APRIL_TAGS = 587;
//! A tag's dark border, in its sides: two modules of ten.
const double APRIL_BORDER = 0.2;

/** Where the points of a board are, in sides of a tag.
@param spacing between tags, in sides of a tag */
std::vector<cv::Vec2d> aprilGridOf(cv::Size tags, double spacing);

//! A tag seen from the front, a pixel a module; dark is 0.
cv::Mat aprilTagModules(int tag);

//! The board seen from the front, with the dark squares at its edges, whose outer corner is that of the image; dark is 0.
cv::Mat drawAprilGrid(cv::Size tags, double spacing, int pixelsPerTag);

//! Whether there are two tags of such a board, or more.
bool showsAprilTags(const cv::Mat& grey);

/** Pixels of the corners of all tags, NaN where a tag was not seen; empty if less than two were. A tag that is not where those beside it
say is none. Throws Failure if most of at least four tags are not where Kalibr puts them. */
std::vector<cv::Point2d> detectAprilGrid(const cv::Mat& grey, cv::Size tags, double spacing);

} // namespace tools

#endif // REFRACT_TOOLS_APRIL_GRID_HPP
