// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MEASURED_POINTS_HPP
#define REFRACT_TOOLS_MEASURED_POINTS_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace tools {

//! A line of what refract_measure wrote.
struct MeasuredPoint
{
    std::string image;                      //!< stem: the view
    std::vector<cv::Point2d> pixels;        //!< of each camera, raw; NaN: not seen
    cv::Point3d X;                          //!< frame of camera 1
};

//! Points that have a place. Throws Failure that names file and line.
std::vector<MeasuredPoint> readMeasuredPoints(const std::string& path, int cameras);

} // namespace tools

#endif // REFRACT_TOOLS_MEASURED_POINTS_HPP
