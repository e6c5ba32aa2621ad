// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_COVARIANCE_HPP
#define OPENCV_REFRACT_COVARIANCE_HPP

#include "calibrate/information.hpp"

namespace cv { namespace refract {

const int REQUIRE_ALL = GLASS_REQUIRE_WINDOW | GLASS_REQUIRE_INTRINSICS | GLASS_REQUIRE_EXTRINSICS;

/** What the data can and cannot tell: covariance of the public parameters of a solved problem, P x P; 0 where fixed. Throws,
naming the direction, if the data do not determine what is free.
@param variance of a pixel coordinate
@param required what must be determined by itself, GLASS_REQUIRE_...; of the rest it is enough that combinations are */
Eigen::MatrixXd rigCovariance(const RigProblem& rig, double variance, int required = REQUIRE_ALL);

/** H, H H^T = covariance of the free parameters for unit pixel noise, from information that also scene points left; only what
is lost altogether is refused. */
Eigen::MatrixXd halfCovariance(const RigProblem& rig, const Information& information);
//! Of the public parameters, from H.
Eigen::MatrixXd publicCovariance(const RigProblem& rig, const Eigen::MatrixXd& half, double variance);

}} // namespace

#endif // OPENCV_REFRACT_COVARIANCE_HPP
