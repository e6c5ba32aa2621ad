// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DOT_TARGET_HPP
#define REFRACT_TOOLS_DOT_TARGET_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace tools {

//! A target whose dots are where a file says, on one level or several.
struct ListedDots
{
    std::vector<std::string> ids;
    std::vector<cv::Point3d> points;
};

/** id,x,y,z, one row a dot; or, without a heading, as OpenPTV has it: number, x, y, z in each line. Throws Failure that names file and
line, also for fewer than eight dots, and for two that have an id or a place in common. */
ListedDots readListedDots(const std::string& path);

/** The images of the centres of dots, bright or dark, NaN where one was not seen; empty if the target was not found. Who is who: see
matchDots(). */
std::vector<cv::Point2d> detectListedDots(const cv::Mat& grey, const std::vector<cv::Point3d>& dots);

} // namespace tools

#endif // REFRACT_TOOLS_DOT_TARGET_HPP
