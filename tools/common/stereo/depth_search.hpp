// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DEPTH_SEARCH_HPP
#define REFRACT_TOOLS_DEPTH_SEARCH_HPP

#include "match/depth_range.hpp"
#include "match/features.hpp"

/* The depth range of a scene, from features that are matched in both raw images. */
namespace tools {

/** z (camera-1 frame) of features matched in both images, whose two rays meet; ascending.
@param image1, image2 of one moment, 8-bit, grey or colour */
std::vector<float> depthsOfFeatures(const Calibration& calibration, const cv::Mat& image1, const cv::Mat& image2);

/** Robust ends of the depths, a little wider.
@param depths ascending; throws Failure that asks for --depth if there are fewer than MIN_FEATURES */
cv::Vec2d depthRangeOf(const std::vector<float>& depths);

} // namespace tools

#endif // REFRACT_TOOLS_DEPTH_SEARCH_HPP
