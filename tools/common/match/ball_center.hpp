// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BALL_CENTER_HPP
#define REFRACT_TOOLS_BALL_CENTER_HPP

#include "target/refine_dots.hpp"
#include <opencv2/refract.hpp>

namespace tools {

struct BallCenter
{
    cv::Point2d pixel;          //!< where the ball's centre is seen
    double radius;              //!< of the ball, as its image has it at that distance; NaN: nothing can be seen there
};

/** The middle of a ball's image is not where its centre is seen: off the axis the far side of the image is stretched, and a window adds
to that. The rays of the outline touch the ball, which says where its centre is.
@param near about where the centre is, in the frame of the camera: its distance is taken */
BallCenter centerOfBall(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const DotImage& outline, const cv::Point3d& near);

} // namespace tools

#endif // REFRACT_TOOLS_BALL_CENTER_HPP
