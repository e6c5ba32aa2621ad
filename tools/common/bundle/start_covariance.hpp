// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_START_COVARIANCE_HPP
#define REFRACT_TOOLS_START_COVARIANCE_HPP

#include "calibrate/given_std.hpp"
#include "calibrate/rig_model.hpp"
#include <functional>

/* What is known of a rig before its matches: a covariance of all its parameters, in which a row of zeros is exact, or free. */
namespace tools {

/** Of nominal values, as well as a data sheet knows them, as in refract_calib; the rig gets the wedges and the bow that are estimated
within that.
@param of how well the values of a window are given */
cv::Mat covarianceOfGiven(const std::function<GivenStd(const cv::refract::GlassWindow&)>& of, int flags, RigModel& rig);

//! What flags free and the windows have not yet, which starts at 0; of what was known nothing is lost.
void addFree(int flags, RigModel& rig, cv::Mat& covariance);

//! What is free again: the earlier calibration has no say. @param free names of --free
void forget(const std::vector<std::string>& free, const RigModel& rig, cv::Mat& covariance);

} // namespace tools

#endif // REFRACT_TOOLS_START_COVARIANCE_HPP
