// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_TARGET_POSE_HPP
#define REFRACT_TOOLS_TARGET_POSE_HPP

#include "calibrate/calib_file.hpp"
#include "measure/eigen_matrix.hpp"

namespace tools {

/** The pose of least squares of a target in camera 1 (rvec, tvec: target -> camera 1), and its error to first order,

    dpose = K^+ (dpixels - A dp),       K: pixels by pose, A: pixels by the parameters p of lens and window. */
struct TargetPose
{
    cv::Vec3d rvec, tvec;
    double residual;            //!< px, standard deviation of a pixel coordinate from what the pose leaves
    MatrixXd byNoise;           //!< 6x6, covariance of the pose for a noise of 1 px
    MatrixXd byParameters;      //!< 6 rows: -K^+ A

    cv::Matx33d rotation() const;
    //! Of a point of the target, in camera 1, by the pose: 3x6.
    MatrixXd differentiatePoint(const cv::Point3d& objectPoint) const;
};

//! Throws Failure if no pose explains the pixels. @param pixels NaN: not seen
TargetPose poseOfTarget(const Calibration& calibration, const std::vector<cv::Point3d>& objectPoints,
                        const std::vector<cv::Point2d>& pixels);

//! Of lens and window of camera 1, also out of that of a rig; zero where the file has none.
MatrixXd covarianceOfCamera1(const Calibration& calibration, Eigen::Index parameters);

} // namespace tools

#endif // REFRACT_TOOLS_TARGET_POSE_HPP
