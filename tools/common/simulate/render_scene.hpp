// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RENDER_SCENE_HPP
#define REFRACT_TOOLS_RENDER_SCENE_HPP

#include "simulate/exposure.hpp"
#include "simulate/solid_texture.hpp"
#include "simulate/surface.hpp"

#include <memory>
#include <vector>

namespace tools {

struct Illumination;

//! Surfaces with one texture through all of them.
struct TexturedScene
{
    std::vector<std::shared_ptr<const Surface>> surfaces;
    TextureOptions texture;
    uint64_t seed = 1;              //!< of the texture
};

//! The first surface on the ray of a sample, or none.
struct SurfaceHit
{
    const Surface* surface = nullptr;
    Intersection intersection;
};

SurfaceHit firstSurface(const TexturedScene& scene, const SceneRay& ray);

/** z in the camera's frame of the first surface that each pixel's centre sees, float32; NaN where it sees none, or where the lens
or the window has no ray. */
cv::Mat depthOfScene(const TexturedScene& scene, const Viewpoint& view);

/** The image, 8 bits, blue, green, red. Every sample, 2x2 in each pixel, has a ray of its own, followed through the lens and
the window to the first surface. What it finds there: the surface's colour times the texture, in the light of a lamp that is far
off, up and to the left of camera 1, and some light from everywhere. No shadows. Lit from the front, a white surface has the
level `light`, without light `dark`. Lines and fringes of emitters are added to it; surfaces do throw shadows in their light. */
cv::Mat renderScene(const TexturedScene& scene, const Viewpoint& view, const Exposure& exposure, uint64_t seed,
                    const Illumination* light = nullptr);

} // namespace tools

#endif // REFRACT_TOOLS_RENDER_SCENE_HPP
