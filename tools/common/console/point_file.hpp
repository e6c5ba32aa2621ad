// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_POINT_FILE_HPP
#define REFRACT_TOOLS_POINT_FILE_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace tools {

/** Pixels from a text file, one "u v" or "u,v" a line; lines with '#' are comments. A first line with the column names u, v
(or u1, v1: the points.csv of refract_measure) tells which columns to take; otherwise it is the first two.
Throws Failure that names file and line. */
std::vector<cv::Point2d> readPixels(const std::string& path);

} // namespace tools

#endif // REFRACT_TOOLS_POINT_FILE_HPP
