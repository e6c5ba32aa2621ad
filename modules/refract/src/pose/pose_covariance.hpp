// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_POSE_COVARIANCE_HPP
#define OPENCV_REFRACT_POSE_COVARIANCE_HPP

#include "pose/near_origin.hpp"
#include "pose/poses.hpp"

/* What noise and an inexact camera do to a pose. With whitened errors e, J their derivatives by the pose, K those by the
camera's parameters, the pose of the least squares is moved by -(J^T J)^-1 J^T (e + K dc), so that its covariance is

    sigma^2 (J^T J)^-1 + G C G^T,    G = (J^T J)^-1 J^T K */

namespace cv { namespace refract {

/** A camera's covariance as users give it: of the lens parameters or of all, or nothing (empty). Throws with the argument's name.
@return parameterCount() square, or empty */
Mat readCameraCovariance(InputArray covariance, const Camera& camera, const String& name);

//! What users say of the noise.
struct PoseNoise
{
    double sigma;           //!< of a pixel's coordinate; 0: estimated from the residuals
    Mat camera;             //!< covariance of its parameters, or empty
};

PoseNoise readPoseNoise(double sigma, InputArray cameraCovariance, const Camera& camera);

//! Of (rvec, tvec); NaN where the points do not tell it, or sigma.
Matx66d poseCovariance(const Camera& camera, const ImagePoints& points, const Pose& pose, const PoseNoise& noise);
//! Of the pose of points that were moved near, for those that were given.
Matx66d poseCovariance(const Camera& camera, const ImagePoints& points, const NearOrigin& origin, const Pose& pose,
                       const PoseNoise& noise);

}} // namespace

#endif // OPENCV_REFRACT_POSE_COVARIANCE_HPP
