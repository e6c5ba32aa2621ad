// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BOARD_POINTS_HPP
#define REFRACT_TOOLS_BOARD_POINTS_HPP

#include "accept/test_points.hpp"
#include "target/target.hpp"

namespace tools {

//! Boards that a rig saw, measured as refract_measure does, and the files in which they were seen.
struct BoardPoints
{
    TestPoints points;
    std::vector<std::string> files;
};

/** @param images of each camera, a glob or a file of points @param pixelSigma of their noise
Throws Failure if no two cameras have images of one name with the board, or no point has an answer. */
BoardPoints measureBoards(const Calibration& calibration, const std::vector<std::string>& images, const Target& target, double pixelSigma,
                          bool quiet);

} // namespace tools

#endif // REFRACT_TOOLS_BOARD_POINTS_HPP
