// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/given_normals.hpp"
#include "calibrate/given_window.hpp"
#include "console/failure.hpp"
#include "console/options.hpp"

namespace tools {

void GivenNormals::addTo(OptionParser& parser)
{
    parser.add("--normal", texts_, "what is known of the normal of a flat window: X,Y,Z in the camera's frame; once for all cameras, or "
        "once for each").oneAtATime();
    parser.add("--normal-std", stdDeg_, "how well, one standard deviation about each of two axes, degrees: the normal is estimated "
        "within it").needs(parser.get("--normal")).check(moreThanZero());
}

std::vector<cv::Vec3d> GivenNormals::of(int cameras, bool isShared) const
{
    if (isSaid() && !(stdDeg_ > 0.))
        throw Failure("--normal=" + texts_[0] + ": say how well it is known, --normal-std=1 for a degree");
    if (texts_.size() > 1 && (int)texts_.size() != cameras)
        throw Failure(cv::format("--normal is given %zu times, and there are %d cameras: give it once for all, or once for each",
                                 texts_.size(), cameras));
    if (texts_.size() > 1 && isShared)
        throw Failure(cv::format("--normal is given %zu times, and all cameras look through one window: give that of camera 1",
                                 texts_.size()));
    std::vector<cv::Vec3d> normals;
    for (const std::string& text : texts_)
    {
        const cv::Vec3d n = parseVector(text, "--normal");
        if (!(n[2] > 0.))
            throw Failure("--normal=" + text + ": it points from the camera to the scene, so that its z is more than 0");
        normals.push_back(cv::normalize(n));
    }
    return normals;
}

} // namespace tools
