// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ROW_CELLS_HPP
#define REFRACT_TOOLS_ROW_CELLS_HPP

#include "stereo/dense_stereo.hpp"

namespace tools {

//! How far the matches of a region of rectified1 miss their rows.
struct RowCell
{
    cv::Point at;           //!< pixel of the match that is the median
    double offset;          //!< px: the median
    double sigma;           //!< of the median, from the differences in the region
};

//! Regions all over the image, where they have enough points.
std::vector<RowCell> rowCellsOf(const DenseStereo& stereo);

//! RMS of their offsets; NaN if there are none.
double rowOffsetOf(const std::vector<RowCell>& cells);

} // namespace tools

#endif // REFRACT_TOOLS_ROW_CELLS_HPP
