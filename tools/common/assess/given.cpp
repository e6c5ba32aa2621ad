#include "assess/given.hpp"

using namespace cv::refract;

namespace tools {

bool hasPairs(const RigData& data)
{
    return data.countPairs(0) + (data.cameraCount == 2 ? data.countPairs(1) : 0) > 0;
}

Given oneCamera(const Given& given, int camera)
{
    Given one = given;
    one.data.cameraCount = 1;
    one.data.imageSize[0] = given.data.imageSize[camera];
    one.options.known[0] = given.options.known[camera];
    one.options.flags &= ~GLASS_SHARED_WINDOW;
    one.data.moments.clear();
    for (const Moment& m : given.data.moments)
        if (m.hasDirect(camera) || m.hasGlass(camera))
        {
            one.data.moments.push_back({});
            one.data.moments.back().stem = m.stem;
            one.data.moments.back().direct[0] = m.direct[camera];
            one.data.moments.back().glass[0] = m.glass[camera];
        }
    return one;
}

} // namespace tools
