// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/assessment.hpp"

using namespace cv;

namespace tools {

Assessment assess(const RigCalibration& c)
{
    Calibration calibration = calibrationOf(c.fit.rig);
    calibration.covariance = c.fit.covariance;
    Assessment result;
    const Vec3d depth = workingDepth(c, 0);
    for (double z : {0.5*depth[0], depth[0], depth[1], depth[2], 1.5*depth[2], 2.*depth[2]})
        result.errors.push_back(mapErrors(calibration, z, c.fit.sigma, ERROR_MAP_COLUMNS));
    for (const ErrorLimit& limit : c.limits.errors)
        result.limits.push_back(mapErrors(calibration, limit.range, c.fit.sigma, ERROR_MAP_COLUMNS));
    result.budget = uncertaintyBudget(c);
    result.advice = adviseImages(c);
    result.contradictions = testGivenValues(c.data, c.options, c.fit);
    return result;
}

} // namespace tools
