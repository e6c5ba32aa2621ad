// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_POINT_DERIVATIVES_HPP
#define REFRACT_TOOLS_POINT_DERIVATIVES_HPP

#include <opencv2/refract.hpp>
#include <Eigen/Core>

namespace tools {

//! How the pixels of points move, u, v of each point; NaN where there is none.
struct PointDerivatives
{
    Eigen::MatrixXd byPose;             //!< rvec, tvec
    Eigen::MatrixXd byParameters;       //!< of lens and window
};

PointDerivatives differentiatePoints(const cv::Ptr<cv::refract::RefractiveCamera>& camera,
                                     const std::vector<cv::Point3d>& points, const cv::Vec3d& rvec, const cv::Vec3d& tvec);

} // namespace tools

#endif // REFRACT_TOOLS_POINT_DERIVATIVES_HPP
