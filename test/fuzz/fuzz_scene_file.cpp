// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "file_harness.hpp"
#include "simulate/scene_file.hpp"

// RIG.yml of refract_simulate.

const char fuzz::EXTENSION[] = ".yml";

void fuzz::tryFile(const std::string& path)
{
    const tools::Scene scene = tools::readScene(path);
    promise(!scene.sets.empty(), "a scene has images to render");
    for (const tools::ImageSet& set : scene.sets)
    {
        promise(set.scene ? !scene.surfaces.surfaces.empty() : !set.poses.empty(), "a set has something to render");
        for (const tools::NamedPose& pose : set.poses)
            promise(cv::checkRange(pose.pose.rvec) && cv::checkRange(pose.pose.tvec), "poses are finite");
    }
}
