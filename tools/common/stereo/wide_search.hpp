// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_WIDE_SEARCH_HPP
#define REFRACT_TOOLS_WIDE_SEARCH_HPP

#include "match/depth_range.hpp"
#include "match/features.hpp"
#include "stereo/rectified_rig.hpp"
#include <memory>

/* A matcher that is told a range of depths finds a partner in it for what lies elsewhere, too. So small images are matched over all
depths, from as near as both cameras see to infinity: what looks alike outside the range is not in it. */
namespace tools {

/* The depth range of a scene, from features that are matched in both raw images. */

/** z (camera-1 frame) of features matched in both images, whose two rays meet; ascending.
@param image1, image2 of one moment, 8-bit, grey or colour */
std::vector<float> depthsOfFeatures(const Calibration& calibration, const cv::Mat& image1, const cv::Mat& image2);

/** Robust ends of the depths, a little wider; nearer only where that is not in the window.
@param depths ascending; throws Failure that asks for --depth if there are fewer than MIN_FEATURES */
cv::Vec2d depthRangeOf(const std::vector<float>& depths, const Calibration& calibration);

//! Depths at which both images look alike, whatever was asked for.
struct WideDepths
{
    cv::Mat least, most;        //!< CV_32F, of pixels of the small image: z (camera-1 frame) is between them; NaN: not known
    std::vector<float> sorted;  //!< those that are known, ascending; may be infinite
    int nearer = 0, farther = 0;    //!< of these outside the range, clearly
    double outside() const;     //!< share of the known ones; 0 if there are none
};

class WideSearch
{
public:
    //! @param asked the rig for the range of depths that is asked for
    WideSearch(const Calibration& calibration, const RectifiedRig& asked);

    //! Both images of one moment, 8-bit, grey or colour.
    WideDepths look(const cv::Mat& image1, const cv::Mat& image2) const;

    /** Removes points where the wide search sees the scene clearly outside the range.
    @param onlyConfirmed keeps only those that the wide search sees, too
    @param points CV_32FC3, camera-1 frame; NaN: none */
    void removeContradicted(const WideDepths& seen, bool onlyConfirmed, cv::Mat& points) const;

private:
    bool isContradicted(const WideDepths& seen, bool onlyConfirmed, const cv::Vec3f& X, const cv::Matx33d& K_turn,
                        const cv::Vec3d& offset) const;

    cv::Vec2d range_;
    double scale_;
    std::unique_ptr<RectifiedRig> rig_;     //!< none: the range cannot be made wider
};

} // namespace tools

#endif // REFRACT_TOOLS_WIDE_SEARCH_HPP
