// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DENSE_STEREO_HPP
#define REFRACT_TOOLS_DENSE_STEREO_HPP

#include "stereo/rectified_rig.hpp"
#include <opencv2/core.hpp>
#include <algorithm>

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

//! z (camera-1 frame) of each pixel of the raw image of camera 1, CV_32F; NaN where nothing was matched.
cv::Mat depthOfRawPixels(const RectifiedRig& rig, const DenseStereo& stereo);

//! Both images of a moment, rectified, and for each new pixel the raw one that it was taken from (CV_32FC2).
struct RectifiedImages
{
    cv::Mat image[2], map[2];
};

/** @param depth1, depth2 as initRefractiveStereoRectifyMap's
@param scale of the new images, beside the rig's */
RectifiedImages rectify(const RectifiedRig& rig, const cv::Mat& image1, const cv::Mat& image2, cv::InputArray depth1,
                        cv::InputArray depth2, double scale);

//! Grey, and turned so that partners lie along the rows: those of a vertical pair lie along the columns.
cv::Mat forMatcher(const RectifiedRig& rig, const cv::Mat& image);
//! The way back.
cv::Mat fromMatcher(const RectifiedRig& rig, const cv::Mat& image);

//! Disparity along the rows, in pixels of the given grey images; NaN: none.
cv::Mat match(const cv::Mat& first, const cv::Mat& second, int minDisparity, int disparities, const MatcherOptions& options);

/* A search in smaller images is made in slabs of depths, each rectified for a plane of its own: for so many that rows agree to a
fraction of its pixels. Mostly one will do; a wide lens before water needs a dozen. */
class Slabs
{
public:
    //! @param scale of the smaller images
    Slabs(const RectifiedRig& rig, double scale) : rig_(rig), scale_(scale)
    {
        const double TYPICAL = 0.3, LARGEST = 1.5;      // px of the smaller images
        const int MOST = 64;
        count_ = std::clamp(cvCeil(scale*std::max(rig.rowError[0]/TYPICAL, rig.rowError[1]/LARGEST)), 1, MOST);
    }
    int count() const { return count_; }
    //! First disparity of a slab, full size; of the one after the last, the end.
    double begin(int k) const { return rig_.minDisparity() + k*(double)rig_.disparities()/count_; }
    //! z of its plane in the rectified frame.
    double depth(int k) const
    {
        // Disparities are those of the whole image: beyond infinity, and far before the range, there is nothing.
        const double farthest = std::max(begin(k), rig_.shift()), middle = std::max(0.5*(farthest + begin(k + 1)), rig_.shift() + 0.5);
        return count_ == 1 ? rig_.planeDepth() : std::max(rig_.depthOf(middle), 0.5*rig_.depthRange()[0]);
    }
    //! First disparity of the smaller images, and how many a matcher takes.
    int from(int k) const { return cvFloor(begin(k)*scale_); }
    int disparities(int k) const { return cvCeil((begin(k + 1)*scale_ + 1 - from(k))/16)*16; }

private:
    const RectifiedRig& rig_;
    double scale_;
    int count_;
};

} // namespace tools

#endif // REFRACT_TOOLS_DENSE_STEREO_HPP
