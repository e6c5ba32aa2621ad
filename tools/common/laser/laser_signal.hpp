// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LASER_SIGNAL_HPP
#define REFRACT_TOOLS_LASER_SIGNAL_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

/* An image in which little but the laser line is bright: by how much its colour exceeds the two others, which are the same on white, grey
and black; or what an image without the laser does not show; or the brightness. */
namespace tools {

enum LaserColour { LASER_BLUE, LASER_GREEN, LASER_RED, LASER_ANY };

//! "red", "green", "blue", "any"
std::vector<std::string> laserColourNames();
LaserColour laserColourOf(const std::string& name);

/** @param image grey or BGR, 8 or 16 bits (a 16-bit one counts 256 as one grey value)
@param without the same view with the laser off, of the same size and type; or empty
@return CV_32F */
cv::Mat laserSignal(const cv::Mat& image, LaserColour colour, const cv::Mat& without = cv::Mat());

} // namespace tools

#endif // REFRACT_TOOLS_LASER_SIGNAL_HPP
