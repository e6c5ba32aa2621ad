// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_EPIPOLAR_CHECK_HPP
#define REFRACT_TOOLS_EPIPOLAR_CHECK_HPP

#include "stereo/rectified_match.hpp"

namespace tools {

/** Takes away the points whose two raw pixels are no images of one point, as they miss each other's epipolar curve by more than
a pixel: where an edge of the scene makes the maps of the second pass wrong, the matcher still finds something in the row.
@param points CV_32FC3, camera-1 frame, of each pixel of the rectified image 1 */
void dropImpossible(const RectifiedRig& rig, const RectifiedImages& rectified, const cv::Mat& disparity, cv::Mat& points);

} // namespace tools

#endif // REFRACT_TOOLS_EPIPOLAR_CHECK_HPP
