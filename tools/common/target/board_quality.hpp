// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BOARD_QUALITY_HPP
#define REFRACT_TOOLS_BOARD_QUALITY_HPP

#include "target/target.hpp"

namespace tools {

//! How well an image shows the board, for whoever holds it.
struct BoardQuality
{
    double edgeWidth[2];        //!< px from 10 to 90 % of an edge, median; across the rows and the columns; at best 2; NaN: not known
    double contrast;            //!< grey levels between dark and light, median
    double saturated, dark;     //!< shares of the board's pixels at the end of the scale

    double worstEdge() const;
    //! "edges 1.8 px, 0 % saturated, 3 % black"
    std::string words() const;
    //! What to do about a bad image; empty: nothing.
    std::string complaint() const;
};

/** @param grey 8 bits
@param points as Target::detect() */
BoardQuality boardQuality(const cv::Mat& grey, const std::vector<cv::Point2d>& points, const Target& target);

} // namespace tools

#endif // REFRACT_TOOLS_BOARD_QUALITY_HPP
