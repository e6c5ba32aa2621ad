// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_SCENE_PAIR_HPP
#define REFRACT_TEST_SCENE_PAIR_HPP

#include "calibrate/calib_file.hpp"
#include "console/images.hpp"
#include "paths.hpp"

//! The bundled scene: planes and spheres 450 to 1150 mm deep, two cameras behind tilted windows.
struct ScenePair
{
    const std::string folder = paths::bundled() + "/scene";
    tools::Calibration rig = tools::readCalibration(folder + "/truth.yml");
    cv::Mat left = tools::readImage(folder + "/glass1/scene.jpg"), right = tools::readImage(folder + "/glass2/scene.jpg");
};

#endif // REFRACT_TEST_SCENE_PAIR_HPP
