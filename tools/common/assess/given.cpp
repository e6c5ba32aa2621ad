// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/given.hpp"

using namespace cv::refract;

namespace tools {

bool hasPairs(const RigData& data)
{
    return data.countPairs() > 0;
}

Given oneCamera(const Given& given, int camera)
{
    Given one = given;
    one.data.cameraCount = 1;
    one.data.imageSize[0] = given.data.imageSize[camera];
    one.options.known[0] = given.options.known[camera];
    one.options.knownCovariance[0] = given.options.knownCovariance[camera];
    one.options.windows.clear();
    one.options.flags &= ~GLASS_USE_POSES;      // they are of camera 1
    one.data.moments.clear();
    for (const Moment& m : given.data.moments)
        if (m.hasDirect(camera) || m.hasGlass(camera))
        {
            Moment alone = m;
            alone.direct = alone.glass = {};
            alone.direct[0] = m.direct[camera];
            alone.glass[0] = m.glass[camera];
            one.data.moments.push_back(alone);
        }
    return one;
}

} // namespace tools
