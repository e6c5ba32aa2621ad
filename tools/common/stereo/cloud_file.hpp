// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CLOUD_FILE_HPP
#define REFRACT_TOOLS_CLOUD_FILE_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

/* Points with colour and uncertainty as a PLY file, which every viewer of point clouds reads. */
namespace tools {

struct CloudPoint
{
    cv::Vec3f position, sigma;      //!< sigma: one standard deviation of each coordinate, NaN: unknown
    cv::Vec3b colour;               //!< red, green, blue
};

typedef std::vector<CloudPoint> Cloud;

/** The points that exist.
@param points CV_32FC3, NaN: none
@param image grey or BGR, of the same size
@param sigma CV_32FC3 as points, or empty: unknown */
Cloud cloudOf(const cv::Mat& points, const cv::Mat& image, const cv::Mat& sigma);

//! Vertices with x y z red green blue sx sy sz, binary, little endian. @param unit of length, empty: unknown
void writeCloud(const std::string& path, const Cloud& cloud, const std::string& unit);

} // namespace tools

#endif // REFRACT_TOOLS_CLOUD_FILE_HPP
