// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DETECTED_POINTS_HPP
#define REFRACT_TOOLS_DETECTED_POINTS_HPP

#include "target/detected_images.hpp"
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

/** Points of any target that someone else has found: `view,x,y,z,u,v`, one row an observed point, `view` in place of an
image's stem. x, y, z are in the frame of the target and in the unit of all lengths; a point without u and v was not seen.
Throws Failure that names file and line, also if a view has a point twice. */
std::vector<DetectedImage> readPointsCsv(const std::string& path);

/** The same of a target whose dots have names: a table of points in any program's form (point_table.hpp), whose points are called as the
target's. One that has pixels of one camera only is that of each; a table without frames is one view.
@param yFrom see PixelOrigin */
std::vector<DetectedImage> readPointTableOf(const Target& target, const std::string& path, int camera, cv::Size imageSize,
                                            const std::string& yFrom);

} // namespace tools

#endif // REFRACT_TOOLS_DETECTED_POINTS_HPP
