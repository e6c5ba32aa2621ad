// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LIVE_LIMITS_HPP
#define REFRACT_TOOLS_LIVE_LIMITS_HPP

#include "assess/rig_calibration.hpp"
#include "calibrate/live_rig.hpp"

namespace tools {

/** Whether the images that came so far are enough: the limits of normals and points are met by the covariance of a quick fit of them, or
the best next pair would make points better by less than was asked for. What cannot be fitted yet is not enough.
@param c with data, options and limits; taken by value, as it is fitted
@param leastGain share of the calibration's part of a point's error that the next pair must take off to be waited for; 0: not asked */
Progressed progressOf(RigCalibration c, double leastGain);

} // namespace tools

#endif // REFRACT_TOOLS_LIVE_LIMITS_HPP
