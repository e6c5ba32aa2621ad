// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/fitted_rig.hpp"
#include "calibrate/units.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

std::string ofCamera(const FittedRig& rig, int camera)
{
    return rig.data.cameraCount == 1 ? "" : format(" of camera %d", camera + 1);
}

std::string ofWindow(const FittedRig& rig, int camera)
{
    return countWindows(rig.fit.rig) == 1 ? "" : format(" of camera %d's window", camera + 1);
}

std::string howSure(double deviations)
{
    return format(", a better fit by %.*f sigma", deviations < 10. ? 1 : 0, deviations);
}

double stdOfSum(const Relaxed& found, const std::vector<int>& numbers)
{
    double variance = 0.;
    for (int i : numbers)
        for (int j : numbers)
            variance += found.covariance(i, j);
    return std::sqrt(std::max(0., variance));
}

std::string unitHint(double ratio) { return isRatioOfUnits(ratio) ? " (a wrong unit?)" : ""; }

double squareOf(const RigData& data)
{
    for (const View& view : data.views)
        if (!view.neighbours.empty())
            return norm(view.objectPoints[view.neighbours[0].second] - view.objectPoints[view.neighbours[0].first]);
    return 0.;
}

} // namespace tools
