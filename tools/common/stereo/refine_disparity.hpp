// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_REFINE_DISPARITY_HPP
#define REFRACT_TOOLS_REFINE_DISPARITY_HPP

#include <opencv2/core.hpp>

/* A matcher that fits a parabola to the costs of three whole pixels has sub-pixel disparities that are biased towards whole pixels
(pixel locking), by up to a fifth of a pixel, and states no uncertainty. Least squares refines them: the shift along the row that
makes the patch of the other image equal to that of the first (Lucas and Kanade 1981, in one dimension). */
namespace tools {

struct RefinedDisparity
{
    cv::Mat disparity;      //!< CV_32F; NaN where it was, or where the patch would move by more than a pixel
    /** CV_32F, one standard deviation; NaN as disparity. Patches with more contrast have a smaller one; the scale of all is that
    by which neighbours on smooth surfaces differ, and NaN if there are too few. */
    cv::Mat sigma;
    //! CV_32F, row in the first image - row in the second, px: about 0 if the calibration is right; NaN as disparity.
    cv::Mat rowOffset;
};

/** @param first, second rectified, 8-bit grey; disparity along the rows
@param disparity CV_32F, NaN: none */
RefinedDisparity refineDisparity(const cv::Mat& first, const cv::Mat& second, const cv::Mat& disparity);

} // namespace tools

#endif // REFRACT_TOOLS_REFINE_DISPARITY_HPP
