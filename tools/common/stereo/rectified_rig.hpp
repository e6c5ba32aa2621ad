// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RECTIFIED_RIG_HPP
#define REFRACT_TOOLS_RECTIFIED_RIG_HPP

#include "calibrate/calib_file.hpp"
#include "calibrate/light.hpp"

namespace tools {

//! A pair of cameras, rectified for a range of depths (cv::refract::refractiveStereoRectify), and the disparities of that range.
class RectifiedRig
{
public:
    /** Throws cv::Exception or Failure if both cameras have no common view of the depth range, or it is too near to match.
    @param depthRange z, camera-1 frame; far may be infinity */
    RectifiedRig(const Calibration& calibration, const cv::Vec2d& depthRange);

    cv::Mat R1, R2, P1, P2, Q;
    cv::Vec2d rowError;             //!< RMS and maximum over the depth range with maps for a plane, px
    cv::Size size() const { return size_; }
    bool vertical() const { return vertical_; }
    //! Of the new images, full size.
    int minDisparity() const { return minDisparity_; }
    int disparities() const { return disparities_; }    //!< a multiple of 16
    //! Disparity of what is infinitely far.
    double shift() const;
    //! z in the rectified frame; not of shift() or beyond.
    double depthOf(double disparity) const;
    //! Virtual centre of camera 1, rectified frame.
    cv::Vec3d centre() const;

    const Calibration& calibration() const { return calibration_; }

    /** Colour images are then rectified each channel by itself.
    @param of the calibration's file, for a sentence */
    void correctColours(const ChannelWavelengths& wavelengths, const std::string& of);
    bool correctsColours() const { return !colours_[0].empty(); }
    //! Camera 0 or 1 in the light of each channel; empty: all are corrected as that of the calibration.
    const std::vector<cv::Ptr<cv::refract::RefractiveCamera>>& colours(int camera) const { return colours_[camera]; }
    const cv::Vec2d& depthRange() const { return depthRange_; }
    //! z in the rectified frame of the plane that the first pass is made for.
    double planeDepth() const { return 2/(1/depthRange_[0] + 1/depthRange_[1]); }

private:
    void findDisparities();
    //! disparity - shift(), times the distance from the pinholes.
    double perInverse() const;

    Calibration calibration_;
    std::vector<cv::Ptr<cv::refract::RefractiveCamera>> colours_[2];
    cv::Vec2d depthRange_;
    cv::Size size_;
    bool vertical_;
    int minDisparity_, disparities_;
};

} // namespace tools

#endif // REFRACT_TOOLS_RECTIFIED_RIG_HPP
