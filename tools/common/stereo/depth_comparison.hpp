// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DEPTH_COMPARISON_HPP
#define REFRACT_TOOLS_DEPTH_COMPARISON_HPP

#include "calibrate/calib_file.hpp"
#include "stereo/cloud_file.hpp"

/* Measured depth against a known one. */
namespace tools {

struct DepthComparison
{
    int known = 0;          //!< pixels with a true depth
    int matched = 0;        //!< those of them with a measured one, too
    int wrong = 0;          //!< those of them that are off by more than WRONG_DEPTH
    double rms = 0;         //!< error of those that are not wrong; NaN if there are none
    int stated = 0;         //!< points that state a sigma and are not wrong
    int within = 0;         //!< those of them whose error is less than 1.96 sigma
};

const double WRONG_DEPTH = 0.02;        //!< share of the true depth

//! True depths of raw pixels of camera 1, CV_32F; throws Failure if the file is not that.
cv::Mat readTrueDepth(const std::string& path, cv::Size size);

//! @param depth, truth CV_32F; NaN, infinite, 0 and less: unknown
DepthComparison compareDepths(const cv::Mat& depth, const cv::Mat& truth);

/** Adds stated and within: where camera 1 sees each point, truth is looked up, between pixels that are of one surface. The
points of a cloud are compared, as a depth map has no sigma. */
void compareSigmas(const Cloud& cloud, const cv::Ptr<cv::refract::RefractiveCamera>& camera, const cv::Mat& truth,
                   DepthComparison& comparison);

} // namespace tools

#endif // REFRACT_TOOLS_DEPTH_COMPARISON_HPP
