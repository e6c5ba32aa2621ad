// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A call of calibrateGlassRig that goes on from where an earlier one has ended.
#ifndef REFRACT_TEST_REFIT_CALL_HPP
#define REFRACT_TEST_REFIT_CALL_HPP

#include "calibrate/refit.hpp"
#include "rig_scenes.hpp"

namespace scenes {

//! @param priors of each camera, or empty
inline double refit(RigCall& call, int flags, const std::vector<cv::Mat>& priors = std::vector<cv::Mat>())
{
    cv::refract::GlassRigOptions options(flags | cv::refract::FROM_EARLIER_FIT);
    options.poseCovariances = call.poseCovariances;
    options.cameraCovariances = priors;
    return call.keep(cv::refract::fitGlassRig(call.object, call.direct, call.refracted, call.cameras, call.windows, call.Rs, call.Ts,
                                              call.rvecs, call.tvecs, options));
}

} // namespace scenes

#endif // REFRACT_TEST_REFIT_CALL_HPP
