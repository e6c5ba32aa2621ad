// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_TRUE_LINE_HPP
#define REFRACT_TOOLS_TRUE_LINE_HPP

#include "simulate/light_source.hpp"
#include "simulate/render.hpp"

namespace tools {

//! The middle of a sheet of light on what a camera sees: a point for each v of the emitter.
struct TrueLine
{
    std::vector<cv::Point2d> pixels;
    std::vector<cv::Vec3d> points;      //!< camera 1's frame
};

//! On a scene: of points that the camera sees.
TrueLine trueLine(const LightSource& source, bool window, const TexturedScene& scene, const Viewpoint& camera);

//! On a target. @param pose in camera 1
TrueLine trueLine(const LightSource& source, bool window, const Target& target, const BoardPose& pose, const Viewpoint& camera);

} // namespace tools

#endif // REFRACT_TOOLS_TRUE_LINE_HPP
