// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ROW_CHECK_HPP
#define REFRACT_TOOLS_ROW_CHECK_HPP

#include "stereo/dense_stereo.hpp"
#include <string>

/* Row errors of a pair against what its calibration may be off by, and what could explain them. An error along the rows cannot be
seen: it is a wrong depth. So each cause that explains the errors across the rows is asked for its errors along them. */
namespace tools {

//! How far the matches of a region of rectified1 miss their rows.
struct RowCell
{
    cv::Point at;           //!< pixel of the match that is the median
    double offset;          //!< px: the median
    double sigma;           //!< of the median, from the differences in the region
};

struct RowCheck
{
    double found = NAN;         //!< RMS, px; NaN: too few matches tell
    double expected = NAN;      //!< RMS of one standard deviation, px: of the calibration's covariance and the noise
    double times = 0;           //!< found in units of expected, all directions by themselves: about 1 if all is well
    double depthChange = 0;     //!< share of the depths, RMS: by so much the causes that explain the rows would change them
    std::string causes;         //!< those that explain them best, with their sizes, joined by "or"; empty: none explains them
    bool contradicts() const { return times > 3; }
};

RowCheck checkRows(const RectifiedRig& rig, const DenseStereo& stereo);

} // namespace tools

#endif // REFRACT_TOOLS_ROW_CHECK_HPP
