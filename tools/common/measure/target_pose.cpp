// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/target_pose.hpp"
#include "calibrate/rig_data.hpp"
#include "console/failure.hpp"
#include "math/dense.hpp"
#include "math/rotation.hpp"
#include "measure/rig_vector.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;

namespace tools {

Matx33d TargetPose::rotation() const
{
    return refract::rotationMatrix(rvec);
}

MatrixXd TargetPose::differentiatePoint(const Point3d& objectPoint) const
{
    MatrixXd byPose(3, 6);
    byPose << toEigen(Mat(refract::Rotation(rvec.val).derivativeOf(objectPoint))), MatrixXd::Identity(3, 3);
    return byPose;
}

TargetPose poseOfTarget(const Calibration& calibration, const std::vector<Point3d>& objectPoints, const std::vector<Point2d>& pixels)
{
    const auto& camera = calibration.cameras[0].camera;
    TargetPose pose;
    if (!refract::refractiveSolvePnP(objectPoints, pixels, camera, pose.rvec, pose.tvec))
        throw Failure("no pose of the target explains its points: check --size and --square");
    std::vector<Point3d> seenPoints;
    std::vector<Point2d> seenPixels, predicted;
    for (size_t i = 0; i < pixels.size(); i++)
        if (seen(pixels[i]))
        {
            seenPoints.push_back(objectPoints[i]);
            seenPixels.push_back(pixels[i]);
        }
    refract::refractiveProjectPoints(seenPoints, pose.rvec, pose.tvec, camera, predicted);
    double squares = 0;
    for (size_t i = 0; i < seenPixels.size(); i++)
        squares += std::pow(norm(seenPixels[i] - predicted[i]), 2);
    pose.residual = std::sqrt(squares/std::max(1., 2.*seenPixels.size() - 6));
    const PointDerivatives d = differentiatePoints(camera, seenPoints, pose.rvec, pose.tvec);
    pose.byNoise = refract::inverse(refract::transposeTimes(d.byPose, d.byPose));
    pose.byParameters = -refract::product(refract::timesTranspose(pose.byNoise, d.byPose), d.byParameters);
    return pose;
}

MatrixXd covarianceOfCamera1(const Calibration& calibration, Eigen::Index parameters)
{
    if (calibration.covariance.empty())
        return MatrixXd::Zero(parameters, parameters);
    return toEigen(calibration.covariance).topLeftCorner(parameters, parameters);
}

} // namespace tools
