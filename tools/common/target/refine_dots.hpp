// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_REFINE_DOTS_HPP
#define REFRACT_TOOLS_REFINE_DOTS_HPP

#include <opencv2/core.hpp>
#include <cmath>
#include <vector>

namespace tools {

//! The image of a round dot, an ellipse.
struct DotImage
{
    cv::Point2d centre;
    cv::Matx22d toCircle;       //!< ellipse about its centre -> unit circle
    double out(const cv::Point2d& p) const { return cv::norm(toCircle*cv::Vec2d(p.x - centre.x, p.y - centre.y)); }
    double area() const { return CV_PI/std::abs(cv::determinant(toCircle)); }
    double radius() const { return std::sqrt(area()/CV_PI); }       //!< of a circle of this area
};

/** Fits ellipses to the edges of dots: where the image is half as bright as between what is inside and what is round it, both of
which may get brighter across a dot. Blob detectors use one brightness for all of the image, and are hundredths of a pixel off.
A dot whose surroundings do not do stays as it is.
@param dots in: about where they are
@param reach how far from each dot's centre there is no other one, in units of its radius */
void refineDots(const cv::Mat& grey, std::vector<DotImage>& dots, const std::vector<double>& reach);

} // namespace tools

#endif // REFRACT_TOOLS_REFINE_DOTS_HPP
