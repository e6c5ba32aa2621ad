// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MIXED_POINTS_HPP
#define REFRACT_TOOLS_MIXED_POINTS_HPP

#include "laser/ridges.hpp"

/* A ridge is found in an image that was smoothed. Where the line ends, gets darker or jumps, what was smoothed is of two surfaces, and the
point lies on neither. */
namespace tools {

//! Neighbouring points of one line, in order.
struct LinePiece
{
    std::vector<RidgePoint> points;
    std::vector<int> columns;           //!< of the image, or its rows where the line runs down; growing
    bool byColumns = true;
};

/** Which points mix two surfaces. The sigma of the others gets what the line's bend within the reach of the smoothing makes of them.
@param scale px, of the smoothing @param last column of the image that may have a point; there and at the first a line goes on */
std::vector<bool> mixedPoints(LinePiece& piece, double scale, int first, int last);

} // namespace tools

#endif // REFRACT_TOOLS_MIXED_POINTS_HPP
