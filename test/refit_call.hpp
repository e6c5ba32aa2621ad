// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A call of calibrateGlassRig that goes on from where an earlier one has ended.
#ifndef REFRACT_TEST_REFIT_CALL_HPP
#define REFRACT_TEST_REFIT_CALL_HPP

#include "calibrate/refit.hpp"
#include "rig_scenes.hpp"

namespace scenes {

//! @param priors of each camera, or empty
inline cv::refract::FitStatistics refit(RigCall& call, int flags, const std::vector<cv::Mat>& priors = std::vector<cv::Mat>())
{
    return cv::refract::fitGlassRig(call.object, call.direct, call.refracted, call.cameras, call.windows, call.Rs, call.Ts, call.rvecs,
                                    call.tvecs, call.deviations, call.covariance, call.perViewErrors, call.imageStatus, call.inliers,
                                    call.otherMinima, cv::noArray(), cv::noArray(), flags | cv::refract::FROM_EARLIER_FIT,
                                    call.poseCovariances,
                                    cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 1000, 1e-12), priors);
}

} // namespace scenes

#endif // REFRACT_TEST_REFIT_CALL_HPP
