// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/calibration_input.hpp"
#include "diagnose/image_changes.hpp"
#include <algorithm>

using namespace cv::refract;

namespace tools {

bool hasPairs(const RigData& data)
{
    return data.countPairs() > 0;
}

CalibrationInput oneCamera(const CalibrationInput& input, int camera)
{
    CalibrationInput one = input;
    one.data.cameraCount = 1;
    one.data.imageSize[0] = input.data.imageSize[camera];
    one.options.known[0] = input.options.known[camera];
    one.options.knownCovariance[0] = input.options.knownCovariance[camera];
    if (!one.options.leftOut.empty())
        one.options.leftOut = {input.options.leftOut[camera]};
    if (one.options.places.size() > 1)
        one.options.places = {input.options.places[camera]};
    one.options.windows.clear();
    one.options.flags &= ~GLASS_USE_POSES;      // they are of camera 1
    one.data.views.clear();
    for (const View& view : input.data.views)
        addPart(view, [=](int c, bool) { return c == camera; }, one.data.views);
    exchangeCameras(one.data.views, 0, camera, ALL_IMAGES);
    return one;
}

std::vector<Explanation> bestBelow(double most, const std::vector<Explanation>& tried)
{
    double best = most;
    for (const Explanation& e : tried)
        best = std::min(best, e.px);
    std::vector<Explanation> explaining;
    for (const Explanation& e : tried)
        if (e.px < most && e.px <= EXPLAINS_AS_WELL*best)
            explaining.push_back(e);
    return explaining;
}

std::vector<Explanation> withoutFreer(const std::vector<Explanation>& explaining)
{
    std::vector<Explanation> kept;
    for (const Explanation& e : explaining)
        if (kept.empty() || e.px < kept.back().px)
            kept.push_back(e);
    return kept;
}

} // namespace tools
