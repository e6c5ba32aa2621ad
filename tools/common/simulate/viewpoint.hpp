// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_VIEWPOINT_HPP
#define REFRACT_TOOLS_VIEWPOINT_HPP

#include "simulate/surface.hpp"

#include <opencv2/refract.hpp>
#include <vector>

namespace tools {

//! A camera and where it stands in the scene.
struct Viewpoint
{
    cv::Ptr<cv::refract::RefractiveCamera> camera;
    cv::Matx33d R = cv::Matx33d::eye();         //!< scene -> camera
    cv::Vec3d T = cv::Vec3d();
    //! The camera in the light of blue, green and red; empty: it is the same in all.
    std::vector<cv::Ptr<cv::refract::RefractiveCamera>> colours = {};

    //! z in the camera's frame.
    double depthOf(const cv::Vec3d& point) const { return (R*point + T)[2]; }
};

//! What pixels look along, from where it leaves the window on.
std::vector<SceneRay> raysOf(const std::vector<cv::Point2d>& pixels, const Viewpoint& view);

//! Angle between the rays of neighbouring pixels in the middle of the image, radians; 0 where there are no rays.
double pixelAngle(const Viewpoint& view);

} // namespace tools

#endif // REFRACT_TOOLS_VIEWPOINT_HPP
