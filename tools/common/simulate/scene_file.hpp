// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SCENE_FILE_HPP
#define REFRACT_TOOLS_SCENE_FILE_HPP

#include "calibrate/calib_file.hpp"
#include "calibrate/light.hpp"
#include "simulate/light_source.hpp"
#include "simulate/render.hpp"
#include <string>

/* RIG.yml, what refract_simulate renders (cv::FileStorage):

    target: { pattern: chessboard, size: "6x5", square: 39. }
    camera1: { ... as in calib.yml ... }     # one camera: its keys at top level instead
    camera2: { ... }
    R: ...                                   # camera 1 -> camera 2; of camera 3 they are R3 and T3, and so on
    T: ...
    exposure: { dark: 35., light: 205., background: 110., blur: 0.7, noise: 2., vignetting: 0.2 }
    seed: 1
    channels: [610., 540., 465.]             # wavelengths of red, green and blue, nm, for windows of materials; else grey
    poses:                                   # of the target in camera 1, by name
      board: [ { rvec: [0., 0., 0.], tvec: [-90., -80., 600.] }, ... ]                     # given, or
      pair: { count: 6, distance: [560., 660.], tilt_deg: [5., 30.], roll_deg: 15., margin: 20. }   # drawn
    sets:                                    # folder <name> (several cameras: <name>1, <name>2, ...)
      direct: { window: 0, poses: [ pair ] }
      glass: { window: 1, poses: [ pair ], motion: { rvec: [0., 0., 0.], tvec: [0.02, 0., 0.] } }    # all boards moved by
                                             # it in camera 1, or the cameras' mount by its inverse
      room: { window: 1, scene: 1 }          # the textured scene, told below, in place of the target
      lines: { window: 1, poses: [ pair ], emitters: [ laser ] }    # in the light of these, beside all other
    scene: ...
    texture: ...
    emitters: ...                            # lines and fringes, which light_source.hpp tells

There is a target, a scene, or both. Drawn poses keep every point of the target `margin` pixels inside all images, or those of
`seen_by` cameras, with and without window. */
namespace tools {

/* What RIG.yml says of a textured scene; frame of camera 1:

    texture: { size: 60., contrast: 0.8, octaves: 8 }       # size of the coarsest grains; each octave halves it
    scene:
      - { shape: plane, point: [0., 0., 1000.], normal: [0., 0., 1.] }                # endless, or with
                              # right: [1., 0., 0.], half_size: [200., 100.]           a rectangle
      - { shape: sphere, center: [0., 0., 700.], radius: 80., color: [1., 0.8, 0.6] } */

struct NamedPose
{
    std::string stem;       //!< name of the poses and a number: pair1
    BoardPose pose;         //!< object -> camera 1
};

struct ImageSet
{
    std::string name;
    bool window = true;
    bool scene = false;             //!< of the textured scene; then it has no poses
    RigidTransform motion = {};     //!< of all its boards in camera 1, from their poses
    std::vector<NamedPose> poses;
    std::vector<LightSource> sources = {};

    //! Images of each pose, and of the scene: fringes take several.
    int pictures() const { return sources.empty() ? 1 : sources[0].pictures(); }
};

struct Scene
{
    TargetOptions target;           //!< given() or not
    TexturedScene surfaces;         //!< none, if the file has no scene
    Calibration cameras;
    Exposure exposure;
    uint64_t seed = 1;
    std::vector<ImageSet> sets;
    std::vector<LightSource> sources;
    bool coloured = false;          //!< each colour is seen through the window at its wavelength
    ChannelWavelengths wavelengths;
};

//! Throws Failure (or cv::Exception) that names the file and the key.
Scene readScene(const std::string& filename);

//! Exact pixels of the target's points.
std::vector<cv::Point2d> projectTarget(const Target& target, const BoardPose& pose,
                                       const cv::Ptr<cv::refract::RefractiveCamera>& camera);

} // namespace tools

#endif // REFRACT_TOOLS_SCENE_FILE_HPP
