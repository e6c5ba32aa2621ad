// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_REFINE_DISPARITY_HPP
#define REFRACT_TOOLS_REFINE_DISPARITY_HPP

#include <opencv2/core.hpp>

/* A matcher that compares whole pixels and puts a parabola through three costs answers fractions that lean towards whole ones,
by up to a fifth of a pixel, and does not say how sure it is. What is left is a matter of least squares: by how much must the
patch of the other image move along the row until it is the patch of the first (Lucas and Kanade 1981, in one dimension). */
namespace tools {

struct RefinedDisparity
{
    cv::Mat disparity;      //!< CV_32F; NaN where it was, or where the patch would move by more than a pixel
    /** CV_32F, one standard deviation; NaN as disparity. Patches with more contrast have a smaller one; the scale of all is that
    by which neighbours on smooth surfaces differ, and NaN if too few tell it. */
    cv::Mat sigma;
    /** RMS over the image of the medians, in some regions, by which patches would have to move across the row: 0 if the
    calibration is right. NaN if too few tell it. */
    double rowOffset;
};

/** @param first, second rectified, 8-bit grey; disparity along the rows
@param disparity CV_32F, NaN: none */
RefinedDisparity refineDisparity(const cv::Mat& first, const cv::Mat& second, const cv::Mat& disparity);

} // namespace tools

#endif // REFRACT_TOOLS_REFINE_DISPARITY_HPP
