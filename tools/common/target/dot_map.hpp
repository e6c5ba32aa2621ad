// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DOT_MAP_HPP
#define REFRACT_TOOLS_DOT_MAP_HPP

#include <opencv2/core.hpp>
#include <vector>

namespace tools {

//! Dots of an image, found by where they are.
class DotMap
{
public:
    DotMap(const std::vector<cv::Point2d>& dots, cv::Size image);
    bool isInside(const cv::Point2d& pixel) const;
    //! The nearest dot, if it is nearer than reach (px); -1: none.
    int at(const cv::Point2d& pixel, double reach) const;
    const std::vector<cv::Point2d>& dots() const { return dots_; }

private:
    const std::vector<cv::Point2d>& dots_;
    cv::Mat nearest_;                   //!< of each pixel a label
    std::vector<int> ofLabel_;
};

} // namespace tools

#endif // REFRACT_TOOLS_DOT_MAP_HPP
