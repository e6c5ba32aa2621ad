// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SURFACES_FILE_HPP
#define REFRACT_TOOLS_SURFACES_FILE_HPP

#include "simulate/render_scene.hpp"

#include <string>

/* What RIG.yml says of a textured scene; frame of camera 1:

    texture: { size: 60., contrast: 0.8, octaves: 8 }       # size of the coarsest grains; each octave halves it
    scene:
      - { shape: plane, point: [0., 0., 1000.], normal: [0., 0., 1.] }                # endless, or with
                              # right: [1., 0., 0.], half_size: [200., 100.]           a rectangle
      - { shape: sphere, center: [0., 0., 700.], radius: 80., color: [1., 0.8, 0.6] } */
namespace tools {

//! Throws Failure that names the file and the key.
TexturedScene readSurfaces(const cv::FileNode& scene, const cv::FileNode& texture, const std::string& filename);

} // namespace tools

#endif // REFRACT_TOOLS_SURFACES_FILE_HPP
