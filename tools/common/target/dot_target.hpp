// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DOT_TARGET_HPP
#define REFRACT_TOOLS_DOT_TARGET_HPP

#include <opencv2/core.hpp>
#include <string>
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

/** Which dots of an image are those of a target whose dots are anywhere in space, in one plane or several; neither the camera nor where the
target is need be known. Other dots may be in the image, and dots of the target missing (up to 60 %).

Three neighbours on the target seen as three neighbours in the image say how the target is seen, as far as a camera is a scaled
orthographic one, up to the sign of the depth (Huttenlocher, Ullman: Recognizing solid objects by alignment with an image, 1990). Where the
dots around are then in their places, more are added outwards, and a projective camera follows them. The most dots decide, then
a pinhole camera's residuals, as those tell front from back; of a target that looks the same the other way round the first dot is the one
nearest to the image's upper left.

@return of each dot of the target the one of the image, -1: not seen; empty: the target is not there */
std::vector<int> matchDots(const std::vector<cv::Point3d>& target, const std::vector<cv::Point2d>& dots, cv::Size image);

//! A target whose dots are where a file says, on one level or several.
struct ListedDots
{
    std::vector<std::string> ids;
    std::vector<cv::Point3d> points;
};

/** id,x,y,z, one row a dot; or, without a heading, as OpenPTV has it: number, x, y, z in each line. Throws Failure that names file and
line, also for fewer than eight dots, and for two that have an id or a place in common. */
ListedDots readListedDots(const std::string& path);

/** The images of the centres of dots, bright or dark, NaN where one was not seen; empty if the target was not found. Who is who: see
matchDots(). */
std::vector<cv::Point2d> detectListedDots(const cv::Mat& grey, const std::vector<cv::Point3d>& dots);

} // namespace tools

#endif // REFRACT_TOOLS_DOT_TARGET_HPP
