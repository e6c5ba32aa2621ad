// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CORNERS_VNL_HPP
#define REFRACT_TOOLS_CORNERS_VNL_HPP

#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

namespace tools {

/** Reads mrcal's corners.vnl: a vnlog table with the columns filename, x, y and perhaps level or weight, one row a
point, the points of an image row by row. '-' or a weight of 0 or less = not seen; an image with a single row of '-'
shows no target.
@param count points per image
@return file names in the file's order, each with its points, none if it shows no target */
std::vector<std::pair<std::string, std::vector<cv::Point2d>>> readCornersVnl(const std::string& path, int count);

} // namespace tools

#endif // REFRACT_TOOLS_CORNERS_VNL_HPP
