// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_NEAREST_PINHOLE_HPP
#define REFRACT_TOOLS_NEAREST_PINHOLE_HPP

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

} // namespace tools

#endif // REFRACT_TOOLS_NEAREST_PINHOLE_HPP
