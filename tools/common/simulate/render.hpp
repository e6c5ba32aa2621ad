// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RENDER_HPP
#define REFRACT_TOOLS_RENDER_HPP

#include "calibrate/rigid_transform.hpp"
#include "simulate/light_source.hpp"
#include "simulate/surface.hpp"
#include "target/target.hpp"
#include <opencv2/refract.hpp>
#include <vector>

namespace tools {

//! Object -> camera.
struct BoardPose
{
    cv::Vec3d rvec, tvec;
};

/* Ray tracing, not warping: every pixel's ray is followed through the lens and the window to the target's plane, and
the target is drawn there from its formula. Twice as many samples as pixels each way, each the mean of 8x8 points where
it meets an edge; between pixels the target's coordinates are interpolated linearly, which is wrong by less than 1e-4
pixels at any usual distortion. Blur at the finer resolution, then the mean over each pixel, then noise.
Lines and fringes light what is printed and its rim; a white square has the level `light` without them.
@param pose in camera 1
@param view one camera: a grey image, or in colours if emitters light it; with colours: a colour image */
cv::Mat render(const Target& target, const BoardPose& pose, const Viewpoint& view, const Exposure& exposure, uint64_t seed,
               const Illumination* light = nullptr);

//! Camera 2's pose of a target whose pose in camera 1 is known.
BoardPose inOtherCamera(const BoardPose& pose, const RigidTransform& cam2_from_cam1);

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

#endif // REFRACT_TOOLS_RENDER_HPP
