// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BOARD_LINE_HPP
#define REFRACT_TOOLS_BOARD_LINE_HPP

#include "laser/ridges.hpp"
#include "measure/target_pose.hpp"
#include "target/target.hpp"

/* A laser line on a flat board whose pose is known: on the board it is straight. Edges of the board's pattern, which are bright lines too
where a lens has colours at edges, are where the pattern says; edges that it does not tell (the board's own) are other candidates, among
which the sheet of light decides. */
namespace tools {

//! A point of a line, where its camera ray meets the board.
struct BoardPoint
{
    RidgePoint ridge;
    cv::Point3d inCamera;
    cv::Point2d onBoard;
    cv::Vec2d alongOnBoard;     //!< unit vector
    cv::Vec3d byAcross;         //!< of inCamera, by one pixel across the line
};

struct BoardImage
{
    std::string name;
    TargetPose pose;
    cv::Vec4d plane;                            //!< of the board in camera 1: a x + b y + c z = d
    std::vector<BoardPoint> points;             //!< on the board, off the edges of its pattern
    std::vector<std::vector<int>> candidates;   //!< straight lines among them, the longest first
};

/** @param pixels of the target's points, NaN: not seen. @param signal as laserSignal
@param scale px, of the line's profile */
BoardImage findLinesOnBoard(const std::string& name, const Calibration& calibration, const Target& target,
                            const std::vector<cv::Point2d>& pixels, const cv::Mat& signal, double scale);

} // namespace tools

#endif // REFRACT_TOOLS_BOARD_LINE_HPP
