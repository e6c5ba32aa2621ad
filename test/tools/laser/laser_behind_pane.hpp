// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A laser behind its own tilted pane in water, and ray-traced images of what its line crosses.
#ifndef REFRACT_TEST_TOOLS_LASER_BEHIND_PANE_HPP
#define REFRACT_TEST_TOOLS_LASER_BEHIND_PANE_HPP

#include "laser_scene.hpp"
#include "simulate/render.hpp"

namespace laser {

inline tools::LightSource laserBehindPane()
{
    using cv::Vec3d;
    tools::LightSource result;
    const Vec3d position(15, 210, 10), z = cv::normalize(Vec3d(0, 0, 450) - position), along(1, 0.02, 0);
    const Vec3d y = cv::normalize(along - along.dot(z)*z), x = y.cross(z);
    const cv::refract::GlassWindow window(Vec3d(0.3, 0.1, 1.), 8., 1.52, 30., 1.333);
    result.emitter.camera = cv::refract::RefractiveCamera::create(cv::Matx33d(1000, 0, 200, 0, 1000, 600, 0, 0, 1), cv::noArray(), window);
    result.emitter.camera->setImageSize(cv::Size(400, 1200));
    result.emitter.R = cv::Matx33d(x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]);
    result.emitter.position = position;
    result.emitter.line = 200.;
    result.color = Vec3d(0, 1, 0);
    result.brightness = 90.;
    result.width = 4.;
    result.speckle = 0.1;
    return result;
}

//! A wall across the view; what stands before it is added.
inline tools::TexturedScene wall(double z)
{
    tools::TexturedScene scene;
    scene.texture.size = 30.;
    scene.texture.contrast = 0.2;
    scene.surfaces = {std::make_shared<tools::Plane>(cv::Vec3d(0, 0, z), cv::Vec3d(0, 0, -1), cv::Vec3d(1, 1, 1))};
    return scene;
}

//! An upright bar of the wall's colour.
inline std::shared_ptr<tools::Plane> bar(const cv::Vec3d& middle, const cv::Size2d& size)
{
    return std::make_shared<tools::Plane>(middle, cv::Vec3d(0, 0, -1), cv::Vec3d(1, 0, 0), size, cv::Vec3d(1, 1, 1));
}

inline tools::Exposure exposure()
{
    tools::Exposure e;
    e.dark = 25.;
    e.light = 130.;
    e.background = 60.;
    e.noise = NOISE;
    return e;
}

} // namespace laser

#endif // REFRACT_TEST_TOOLS_LASER_BEHIND_PANE_HPP
