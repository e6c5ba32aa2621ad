// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DENSE_STEREO_HPP
#define REFRACT_TOOLS_DENSE_STEREO_HPP

#include "stereo/rectified_rig.hpp"
#include <opencv2/core.hpp>

/* Dense stereo through windows, in two passes. First the images are made half as large, rectified for one plane and matched;
then rectified anew for the depths found, at full size, where an ordinary matcher sees an ordinary pair. */
namespace tools {

/* A matcher that fits a parabola to the costs of three whole pixels has sub-pixel disparities that are biased towards whole pixels
(pixel locking), by up to a fifth of a pixel, and states no uncertainty. Least squares refines them: the shift along the row that
makes the patch of the other image equal to that of the first (Lucas and Kanade 1981, in one dimension). */

struct RefinedDisparity
{
    cv::Mat disparity;      //!< CV_32F; NaN where it was, or where the patch would move by more than a pixel
    /** CV_32F, one standard deviation; NaN as disparity. Patches with more contrast have a smaller one; the scale of all is that
    by which neighbours on smooth surfaces differ, and NaN if there are too few. */
    cv::Mat sigma;
    //! CV_32F, row in the first image - row in the second, px: about 0 if the calibration is right; NaN as disparity.
    cv::Mat rowOffset;
};

struct MatcherOptions
{
    bool fullPaths = false;     //!< all eight directions of cv::StereoSGBM (MODE_HH), not three
    int passes = 2;             //!< 1: the plane's rectification is all
    int block = 5;              //!< side of the matched block, pixels, odd
};

struct DenseStereo
{
    cv::Mat rectified1, rectified2;     //!< the images, as the last pass matched them
    cv::Mat disparity;                  //!< CV_32F, px, of rectified1; NaN: none
    cv::Mat depth1, depth2;             //!< what the last pass' maps were made for
    cv::Mat points;                     //!< CV_32FC3, camera-1 frame, of each pixel of rectified1; NaN: none
    cv::Mat sigma;                      //!< CV_32FC3, one standard deviation of each of points' coordinates (pointSigma); NaN: unknown
    cv::Mat disparitySigmas;            //!< CV_32F, one standard deviation of disparity, px; NaN: none, or too few matches tell
    cv::Mat rowOffset;                  //!< CV_32F, px, by how much each match misses its row (refineDisparity)
};

//! Both images of one moment, of the rig's size, 8-bit, grey or colour.
DenseStereo matchPair(const RectifiedRig& rig, const cv::Mat& image1, const cv::Mat& image2, const MatcherOptions& options);

} // namespace tools

#endif // REFRACT_TOOLS_DENSE_STEREO_HPP
