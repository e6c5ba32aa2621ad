// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHECK_IMAGES_HPP
#define REFRACT_TOOLS_CHECK_IMAGES_HPP

#include "assess/rig_check.hpp"
#include "calibrate/calibration_images.hpp"
#include "check/check_options.hpp"
#include "match/scene_matches.hpp"

/* The new images of a check. */
namespace tools {

//! What the images are of, a target or a scene, and their files.
struct CheckImages
{
    std::vector<View> views;                    //!< of a target
    SceneMatches scene;
    std::vector<std::string> files;
    std::vector<CalibrationImage> shown;        //!< of a target: what is known of each
};

CheckImages readCheckImages(const CheckOptions& options, const Calibration& calibration, const Command& command);

/** The images against the calibration.
@param input becomes what was tested: with the target's motions between pairs, or the noise of a scene's points */
CheckResult checkImages(const CheckOptions& options, const CheckImages& images, const Calibration& calibration, CheckInput& input);

} // namespace tools

#endif // REFRACT_TOOLS_CHECK_IMAGES_HPP
