// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_POSES_FILE_HPP
#define REFRACT_TOOLS_POSES_FILE_HPP

#include "calibrate/rig_data.hpp"

namespace tools {

/** Poses that are known from outside (a robot, a stage), target -> camera 1, one row a view:

    view,rx_deg,ry_deg,rz_deg,tx,ty,tz[,sigma_deg,sigma]

`view` as the images' stem; r is the rotation vector, as OpenCV's rvec but in degrees, or in radians as rx_rad,ry_rad,rz_rad, or
the matrix r11,r12,...,r33 in its place; t in the unit of all lengths, or in that of the name: tx_mm, tx_cm, tx_m, tx_inch.
sigma_deg is one standard deviation of the rotation about each axis, sigma (or sigma_mm, ...) of the translation along each;
without them, or where both are 0 or empty, a pose is exact.
@param unit of all lengths
Throws Failure that names file and line, or the views of data that have no pose. */
void readPoses(const std::string& path, const std::string& unit, RigData& data);

} // namespace tools

#endif // REFRACT_TOOLS_POSES_FILE_HPP
