// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SCENE_DEPTH_HPP
#define REFRACT_TOOLS_SCENE_DEPTH_HPP

#include <opencv2/core.hpp>
#include <opencv2/refract.hpp>

namespace tools {

//! A camera without a window for programs that know no other, at the centre of projection of one with a window, and what it is off by.
struct NearestPinhole
{
    cv::Ptr<cv::refract::RefractiveCamera> camera;      //!< of OpenCV's model with 4 coefficients, or cv::fisheye's
    double rms = 0., max = 0.;                          //!< px, of these points
};

//! @param points that the camera sees, in its frame; NaN is passed over
NearestPinhole nearestPinhole(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const std::vector<cv::Point3d>& points);

/** Depth all over an image from that of some of its pixels: 1/z is a plane (as that of a plane is), and what the points are off it, of
which each cell has the median, smoothed over some pixels and continued where there are none; never nearer or farther than all points.
@param pixels at least one. @param depths z of each, above 0
@return CV_64F */
cv::Mat_<double> sceneDepth(const std::vector<cv::Point2d>& pixels, const std::vector<double>& depths, cv::Size size);

//! Of pixels in one cell the depth is one.
cv::Point depthCellOf(const cv::Point2d& pixel, cv::Size size);

} // namespace tools

#endif // REFRACT_TOOLS_SCENE_DEPTH_HPP
