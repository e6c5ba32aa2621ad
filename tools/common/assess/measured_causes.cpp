// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/measured_causes.hpp"
#include "assess/rig_check.hpp"
#include "console/failure.hpp"
#include <algorithm>

namespace tools {

std::string causesOf(const Calibration& calibration, const std::vector<View>& views, double pixelSigma)
{
    const size_t MOST = 6;
    const double FALSE_ALARM = 1e-4;
    std::vector<View> some;
    for (size_t i = 0; i < std::min(MOST, views.size()); i++)
        some.push_back(views[i*views.size()/std::min(MOST, views.size())]);
    try
    {
        return causesIn(checkRig(checkInputOf(calibration, "", pixelSigma), some, FALSE_ALARM, calibration.unit));
    }
    catch (const Failure&)          // no pose, no noise
    {
        return "";
    }
}

std::string mixupIn(const Calibration& calibration, const ViewObservations& scene, double sigma)
{
    const double FALSE_ALARM = 1e-4;
    try
    {
        const CheckResult result = checkScene(checkInputOf(calibration, "", sigma), scene, FALSE_ALARM, calibration.unit);
        return result.isMixup && result.explained ? causesIn(result) : "";
    }
    catch (const Failure&)          // too few points
    {
        return "";
    }
}

} // namespace tools
