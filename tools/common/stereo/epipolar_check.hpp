// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_EPIPOLAR_CHECK_HPP
#define REFRACT_TOOLS_EPIPOLAR_CHECK_HPP

#include "stereo/rectified_match.hpp"

namespace tools {

/** Removes the points whose two raw pixels are not images of one point: each is more than a pixel off the other's epipolar curve.
Where an edge of the scene makes the maps of the second pass wrong, the matcher still finds a match in the row.
@param points CV_32FC3, camera-1 frame, of each pixel of the rectified image 1 */
void removeInconsistentPoints(const RectifiedRig& rig, const RectifiedImages& rectified, const cv::Mat& disparity, cv::Mat& points);

} // namespace tools

#endif // REFRACT_TOOLS_EPIPOLAR_CHECK_HPP
