// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_EMITTER_HPP
#define REFRACT_TOOLS_EMITTER_HPP

#include <opencv2/refract.hpp>
#include <cmath>
#include <string>
#include <vector>

/* What draws lines or fringes is a camera that sends light: its pixels of one u are a sheet of light, refracted at its own window.

    emitter: { camera_matrix, distortion_coefficients, glass_window, image_width, image_height as in calib.yml,
               rvec: [0., -0.4, 0.], tvec: [150., 0., 40.],     # camera 1 -> emitter
               line: 320. }                                     # u of a laser's sheet */
namespace tools {

struct Emitter
{
    cv::Ptr<cv::refract::RefractiveCamera> camera;
    cv::Matx33d R = cv::Matx33d::eye();     //!< X_emitter = R (X_camera1 - position)
    cv::Vec3d position;
    double line = NAN;                      //!< u of its sheet

    cv::Vec3d translation() const { return -(R*position); }
};

//! Opens a map of FileStorage. Throws Failure that says why it cannot be read. @param content what it must describe
cv::FileStorage openDescription(const std::string& filename, const std::string& content);

//! The keys that readEmitter() takes.
std::vector<std::string> emitterKeys();

//! Throws Failure that names the map and the key. @param needsLine or there may be none
Emitter readEmitter(const cv::FileNode& node, const std::string& name, bool needsLine);

//! The keys that readEmitter() reads, into the map that is open.
void writeEmitter(cv::FileStorage& fs, const Emitter& emitter);

} // namespace tools

#endif // REFRACT_TOOLS_EMITTER_HPP
