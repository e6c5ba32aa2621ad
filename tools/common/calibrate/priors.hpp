// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PRIORS_HPP
#define REFRACT_TOOLS_PRIORS_HPP

#include "calibrate/starting_model.hpp"

/* What is known before the images, with covariances: a fit takes it from RigModel::known and RigModel::targetCovariance. */
namespace tools {

/** What was known of a camera before: its lens, if a file has it, with the file's covariance, and the window's given values
with the given deviations. */
KnownCamera knownOf(const cv::refract::RefractiveCamera& camera, const RigOptions& options, int c);

/** What is known of the targets that all views share, as calibrateGlassRig's targetCovariance; empty where they are exact. Where boards
moved by so much, they also turned about their mean position, so that their edges moved by as much. */
cv::Mat targetCovarianceOf(const RigData& data, const RigModel& rig, const GivenStd& given);

/** A window of which nobody said where it is, somewhere between camera and targets: as a uniform distribution has it, but sooner near the
camera. */
RigOptions withOpenDistance(const RigData& data, const RigModel& rig, RigOptions options);

} // namespace tools

#endif // REFRACT_TOOLS_PRIORS_HPP
