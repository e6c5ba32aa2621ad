// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/scene_check.hpp"

#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

ViewObservations observationsOf(const RigModel& rig, const Matches& matches)
{
    const std::vector<Point3d> points = triangulate(rig, matches.pixels);
    ViewObservations scene;
    scene.isScene = true;
    std::vector<int> indices(points.size(), -1);
    for (size_t i = 0; i < points.size(); i++)
        if (std::isfinite(points[i].x))
        {
            indices[i] = (int)scene.objectPoints.size();
            scene.objectPoints.push_back(points[i]);
        }
    std::vector<double> pixels, noise;
    const double usual = matches.usualStd();
    for (int c = 0; c < matches.cameraCount(); c++)
    {
        ImageOfView image{c, true, {}};
        for (size_t i = 0; i < points.size(); i++)
            if (indices[i] >= 0 && matches.isSeen(c, (int)i))
            {
                const double relative = matches.stds.empty() ? 1. : matches.stds[c][i]/usual;
                image.points.push_back(indices[i]);
                pixels.insert(pixels.end(), {matches.pixels[c][i].x, matches.pixels[c][i].y});
                noise.insert(noise.end(), {relative, relative});
            }
        if (!image.points.empty())
            scene.images.push_back(image);
    }
    scene.pixels = Eigen::Map<Eigen::VectorXd>(pixels.data(), pixels.size());
    scene.noise = Eigen::Map<Eigen::VectorXd>(noise.data(), noise.size());
    return scene;
}

} // namespace tools
