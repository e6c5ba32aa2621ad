// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_POINT_SIGMA_HPP
#define REFRACT_TOOLS_POINT_SIGMA_HPP

#include "stereo/dense_stereo.hpp"

namespace tools {

/** One standard deviation of x, y and z of each point (camera-1 frame): that of its disparity, along the line of sight, and what
the calibration's covariance, if there is one, does to all points; CV_32FC3.
@param contradiction share of its distance by which a point may be off beside that, as the images contradict the calibration */
cv::Mat pointSigma(const RectifiedRig& rig, const DenseStereo& stereo, double contradiction);

} // namespace tools

#endif // REFRACT_TOOLS_POINT_SIGMA_HPP
