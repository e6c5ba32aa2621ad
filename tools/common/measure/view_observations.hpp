// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_VIEW_OBSERVATIONS_HPP
#define REFRACT_TOOLS_VIEW_OBSERVATIONS_HPP

#include "measure/view_derivatives.hpp"
#include "calibrate/rig_data.hpp"

namespace tools {

//! The observations of one new view, and the current estimate of the board's pose, which is unknown.
struct ViewObservations
{
    std::vector<cv::Point3d> objectPoints;
    std::vector<ImageOfView> images;
    Eigen::VectorXd pixels;             //!< in the order of differentiateView
    cv::Vec3d rvec, tvec;               //!< board -> camera 1
};

//! The seen points of one image, after those that are there; an image without any is none.
void addImage(const View& view, int camera, bool glass, ViewObservations& observed);

//! The pose is that of one of the images. Throws Failure if none has one.
ViewObservations observationsOf(const RigModel& rig, const View& view);

//! Gauss-Newton on the pose. @return the derivatives there
ViewDerivatives refinePose(const RigModel& rig, ViewObservations& observed);

} // namespace tools

#endif // REFRACT_TOOLS_VIEW_OBSERVATIONS_HPP
