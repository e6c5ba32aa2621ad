// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BALL_IMAGE_HPP
#define REFRACT_TOOLS_BALL_IMAGE_HPP

#include "target/refine_points.hpp"

/* Balls that are moved before cameras which do not move: what else is in a picture is there at other moments, too. */
namespace tools {

struct BallImage
{
    DotImage outline;           //!< the middle of its ellipse is not quite where the ball's centre is seen
    double std;                 //!< of a coordinate of that middle, px, by the noise round it
    double contrast;            //!< grey levels between ball and background
};

/** What an image shows where nothing moves: of each pixel the median. Things that stand still, lamps and what panes mirror of them, are
part of it. @param images 8-bit grey, of equal size */
cv::Mat stillBackground(const std::vector<cv::Mat>& images);

const size_t MOST_BALLS = 12;       //!< that are looked at in an image

/** Round things that are not in the background, those with the most contrast first; what is as long as it is not round, or cut by the
image's edge, is none. The outline is the ellipse that explains best, in the sense of least squares, every pixel round it: of a blurred
edge between the background and a ball which may be brighter on one side.
@param bright or darker than the background
@param crowded whether there are more than are looked at */
std::vector<BallImage> ballsIn(const cv::Mat& grey, const cv::Mat& background, bool bright, bool* crowded = nullptr);

} // namespace tools

#endif // REFRACT_TOOLS_BALL_IMAGE_HPP
