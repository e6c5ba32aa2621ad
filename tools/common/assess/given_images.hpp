// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_GIVEN_IMAGES_HPP
#define REFRACT_TOOLS_GIVEN_IMAGES_HPP

#include "assess/rig_calibration.hpp"
#include "calibrate/live_rig.hpp"

namespace tools {

//! What the options of refract_calib say of images, and from these to views.
struct GivenImages
{
    RigSources sources;
    WatchOptions watch;
    double watchGain = 0.;          //!< percent, see sufficiencyOf(); 0: not asked
    std::string imageSize, poses;
    bool unpaired = false;

    /** All that the images tell. Waits for those that are watched.
    @param isDistanceSaid of windows; else they start where the images have it
    @param c with options, limits and unit */
    void read(const Target* target, bool isDistanceSaid, bool quiet, RigCalibration& c) const;

private:
    RigImages readOthers(const RigOptions& rig, const Target* target, bool quiet, const RigImages& watched, const RigSources& left) const;
    RigImages watchThem(const Target* target, const RigCalibration& prepared, bool isDistanceSaid, bool quiet, RigSources& left) const;
    void take(const Target* target, RigImages sets, bool isDistanceSaid, RigCalibration& c) const;
};

} // namespace tools

#endif // REFRACT_TOOLS_GIVEN_IMAGES_HPP
