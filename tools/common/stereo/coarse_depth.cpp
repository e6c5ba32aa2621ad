// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/coarse_depth.hpp"
#include "stereo/rectified_match.hpp"

#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

namespace tools {

using cv::Mat;

namespace {

/* The first pass is made in slabs of depths, each rectified for a plane of its own: for so many that rows agree to a fraction of
its pixels. Mostly one will do; a wide lens before water needs a dozen. */
class Slabs
{
public:
    explicit Slabs(const RectifiedRig& rig) : rig_(rig)
    {
        const double TYPICAL = 0.6, LARGEST = 3;        // px, full size; images of half the size have half of it
        const int MOST = 64;
        count_ = std::clamp(cvCeil(std::max(rig.rowError[0]/TYPICAL, rig.rowError[1]/LARGEST)), 1, MOST);
    }
    int count() const { return count_; }
    //! First disparity of a slab, full size; of the one after the last, the end.
    double begin(int k) const { return rig_.minDisparity() + k*(double)rig_.disparities()/count_; }
    //! z of its plane in the rectified frame.
    double depth(int k) const
    {
        const double middle = 0.5*(begin(k) + begin(k + 1));
        return count_ == 1 ? rig_.planeDepth() : rig_.depthOf(middle);
    }

private:
    const RectifiedRig& rig_;
    int count_;
};

//! How little two rectified images are alike round each pixel of the first, at its disparity; infinite where that is NaN.
Mat unlikeness(const Mat& first, const Mat& second, const Mat& disparity)
{
    Mat columns(disparity.size(), CV_32F), rows(disparity.size(), CV_32F), partners, result;
    for (int y = 0; y < disparity.rows; y++)
        for (int x = 0; x < disparity.cols; x++)
        {
            columns.at<float>(y, x) = (float)x - disparity.at<float>(y, x);
            rows.at<float>(y, x) = (float)y;
        }
    cv::remap(second, partners, columns, rows, cv::INTER_LINEAR);
    cv::absdiff(first, partners, partners);
    cv::blur(partners, result, cv::Size(9, 9));
    result.convertTo(result, CV_32F);
    result.setTo(INFINITY, disparity != disparity);
    return result;
}

//! Disparities of images of half the size; where more than one slab has an answer, that which looks most alike.
Mat coarseDisparity(const RectifiedRig& rig, const Mat& image1, const Mat& image2, const MatcherOptions& options,
                    double& mapSeconds, double& matchSeconds)
{
    const double scale = 0.5;
    const Slabs slabs(rig);
    Mat best, least;
    for (int k = 0; k < slabs.count(); k++)
    {
        const Mat plane(1, 1, CV_64F, cv::Scalar(slabs.depth(k)));
        const RectifiedImages pair = rectify(rig, image1, image2, plane, plane, scale, mapSeconds);
        const Mat first = forMatcher(rig, pair.image[0]), second = forMatcher(rig, pair.image[1]);
        const int from = cvFloor(slabs.begin(k)*scale), count = cvCeil((slabs.begin(k + 1)*scale + 1 - from)/16)*16;
        const Mat found = match(first, second, from, count, options, matchSeconds);
        if (slabs.count() == 1)
            return fromMatcher(rig, found);
        const Mat unlike = unlikeness(first, second, found);
        if (best.empty())
        {
            best = Mat(found.size(), CV_32F, NAN);
            least = Mat(found.size(), CV_32F, INFINITY);
        }
        const Mat better = unlike < least;
        found.copyTo(best, better);
        unlike.copyTo(least, better);
    }
    return fromMatcher(rig, best);
}

} // namespace

void findCoarseDepth(const RectifiedRig& rig, const Mat& image1, const Mat& image2, const MatcherOptions& options, Mat& depth1,
                     Mat& depth2, double& mapSeconds, double& matchSeconds)
{
    const Mat coarse = coarseDisparity(rig, image1, image2, options, mapSeconds, matchSeconds);
    const int64 start = cv::getTickCount();
    const int FEW = 64;
    if (cv::countNonZero(coarse == coarse) > FEW)
        cv::refract::refractiveRectifiedDepth(coarse, rig.P1, rig.P2, rig.size(), depth1, depth2);
    mapSeconds += secondsSince(start);
}

} // namespace tools
