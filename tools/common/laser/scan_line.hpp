// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SCAN_LINE_HPP
#define REFRACT_TOOLS_SCAN_LINE_HPP

#include "laser/ridges.hpp"
#include "laser/sheet.hpp"

/* The laser line on any scene. Along the line, in each column of the image (or row, where depth moves the line along rows), there is one
point of it; of several ridges in a column it is on the clearly strongest, as reflections in panes are weaker. */
namespace tools {

/* A ridge is found in an image that was smoothed. Where the line ends, gets darker or jumps, what was smoothed is of two surfaces, and the
point lies on neither. */

//! Neighbouring points of one line, in order.
struct LinePiece
{
    std::vector<RidgePoint> points;
    std::vector<int> columns;           //!< of the image, or its rows where the line runs down; growing
    bool byColumns = true;
};

struct ScanLine
{
    std::vector<RidgePoint> points;
    int ambiguous = 0;          //!< columns left out, as two lines are about as strong
    int mixed = 0;              //!< points left out, where the line ends, jumps or gets darker
    double noise = 0.;          //!< px, of the points beyond white noise; their sigma has it
};

//! @param depth of the scene; points of other depths are none. Infinity: not known
ScanLine findScanLine(const cv::Mat& signal, const Calibration& calibration, const Sheet& sheet, const cv::Vec2d& depth);

} // namespace tools

#endif // REFRACT_TOOLS_SCAN_LINE_HPP
