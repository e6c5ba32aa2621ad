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

/** The coverage of the images of a board taken so far, before any lens is known: corners in each ninth of the image, boards tilted to
four sides, near and far boards. */
class NextView
{
public:
    static const int ENOUGH = 12;           //!< images, if nothing else is missing

    NextView(const Target& target, cv::Size image) : target_(target), image_(image) {}

    //! @param points of the target, NaN where one was not seen
    void add(const std::vector<cv::Point2d>& points);

    int count() const { return count_; }
    //! What to show next, the most useful first; empty: enough of all.
    std::string advice() const;

private:
    std::string emptyPart() const;
    std::string missingTilt() const;
    std::string missingDistance() const;

    const Target& target_;
    cv::Size image_;
    int count_ = 0;
    int corners_[3][3] = {};                //!< rows, columns of the picture
    bool tilted_[4] = {};                   //!< the left, right, upper, lower edge towards the camera
    double nearest_ = 0., farthest_ = 0.;   //!< the board's size in the picture, of the picture's
};

} // namespace tools

#endif // REFRACT_TOOLS_BOARD_QUALITY_HPP
