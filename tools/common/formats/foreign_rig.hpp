// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FOREIGN_RIG_HPP
#define REFRACT_TOOLS_FOREIGN_RIG_HPP

#include <opencv2/refract.hpp>
#include <optional>
#include <string>
#include <vector>

namespace tools {

//! Cameras that another program has calibrated.
struct ForeignRig
{
    std::string format;                                         //!< whose file it is
    std::vector<cv::Ptr<cv::refract::RefractiveCamera>> cameras;
    std::vector<cv::Mat> Rs, Ts;                                //!< camera 1 -> each camera; empty: the file does not say

    //! A camera at the end; the first one's frame, or any that all share, to its own.
    void add(const cv::Ptr<cv::refract::RefractiveCamera>& camera) { cameras.push_back(camera); }
    void add(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const cv::Matx33d& cam_from_world, const cv::Vec3d& translation);
};

/** Reads the lens files of other programs, which are told from each other by what is in them: OpenCV's with other keys than ours, ROS,
Kalibr, Calibmar, COLMAP, DepthAI, MATLAB, NumPy, OpenPTV, OpenLPT. Exactly, or not at all: pixels count from the centre of the first one
here, lengths stay as they are. A name with %d is that of files numbered from 0 or 1, of a program that has a file for each camera.
Nothing: the file is none of these, or one of refract's own. Throws Failure that names the file, whose it looks like, and what is
wrong with it. */
std::optional<ForeignRig> readForeignRig(const std::string& filename);

} // namespace tools

#endif // REFRACT_TOOLS_FOREIGN_RIG_HPP
