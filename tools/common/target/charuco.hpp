// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHARUCO_HPP
#define REFRACT_TOOLS_CHARUCO_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

/* ChArUco moved from contrib's aruco to objdetect, with another interface, in OpenCV 4.7. Only this pair knows. */
namespace tools {

//! Number of a dictionary by OpenCV's name ("DICT_4X4_250"); throws Failure if there is none.
int charucoDictionary(const std::string& name);

//! Throws Failure if the dictionary has not enough markers for the board.
void requireMarkers(cv::Size innerCorners, int dictionary);

//! The board seen from the front, without margin; dark is 0.
cv::Mat drawCharuco(cv::Size innerCorners, double square, double marker, int dictionary, int pixelsPerSquare);

/** The same, a pixel a module: markers have their bits and a dark border of one module, and one light module round it, so that a
square has two modules more than a marker. */
cv::Mat charucoModules(cv::Size innerCorners, int dictionary);

/** Pixels of all inner corners, NaN where not seen; empty if fewer than four were.
@param legacy the layout of OpenCV before 4.6: boards with an even number of rows of squares have a marker, and not a dark square, in the
first corner. Throws Failure if the markers are where the other layout has them. */
std::vector<cv::Point2d> detectCharuco(const cv::Mat& grey, cv::Size innerCorners, double square, double marker,
                                       int dictionary, bool legacy = false);

} // namespace tools

#endif // REFRACT_TOOLS_CHARUCO_HPP
