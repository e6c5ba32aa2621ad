// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RAW_DEPTH_HPP
#define REFRACT_TOOLS_RAW_DEPTH_HPP

#include "stereo/dense_stereo.hpp"

namespace tools {

//! z (camera-1 frame) of each pixel of the raw image of camera 1, CV_32F; NaN where nothing was matched.
cv::Mat depthOfRawPixels(const RectifiedRig& rig, const DenseStereo& stereo);

} // namespace tools

#endif // REFRACT_TOOLS_RAW_DEPTH_HPP
