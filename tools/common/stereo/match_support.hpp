// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MATCH_SUPPORT_HPP
#define REFRACT_TOOLS_MATCH_SUPPORT_HPP

#include "stereo/dense_stereo.hpp"
#include <opencv2/core.hpp>

/* A matcher fills areas without texture from their neighbours, and finds a best match for noise too. Afterwards the two patches of a
match are compared: both must have texture, and the same. */
namespace tools {

/** Removes the points whose two raw pixels are not images of one point: each is more than a pixel off the other's epipolar curve.
Where an edge of the scene makes the maps of the second pass wrong, the matcher still finds a match in the row.
@param points CV_32FC3, camera-1 frame, of each pixel of the rectified image 1 */
void removeInconsistentPoints(const RectifiedRig& rig, const RectifiedImages& rectified, const cv::Mat& disparity, cv::Mat& points);

struct MatchSupport
{
    cv::Mat mask;           //!< CV_8U, 255: the patches of this match look alike
    cv::Mat nearby;         //!< CV_8U, 255: they do, or those of a match beside it
    cv::Mat correlation;    //!< CV_32F, of the patches; 0: no match, or flat
    int textured = 0;       //!< matches whose patches have more contrast than the noise of the images
    int supported = 0;      //!< those of them that look alike
    //! Of the textured ones; NaN if there are none.
    double share() const;
};

/** In flat areas and by chance the patches of a match do not correlate.
@param first, second as forMatcher() gives them
@param disparity CV_32F, px along rows, of the first; NaN: no match */
MatchSupport supportOf(const cv::Mat& first, const cv::Mat& second, const cv::Mat& disparity);

} // namespace tools

#endif // REFRACT_TOOLS_MATCH_SUPPORT_HPP
