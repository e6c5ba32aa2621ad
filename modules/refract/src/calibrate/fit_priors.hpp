// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_FIT_PRIORS_HPP
#define OPENCV_REFRACT_FIT_PRIORS_HPP

#include "start/rig_task.hpp"

namespace cv { namespace refract {

// What callers know before a fit: poses, covariances of poses, cameras and the target.

//! Of vectors as calib3d keeps poses: one array a view, or one array of 3-vectors.
int countVectors(InputArrayOfArrays a, const char* name);
//! What is not finite is not found.
std::vector<Pose> readPoses(InputArrayOfArrays rvecs, InputArrayOfArrays tvecs, int count);
//! Adds that three coordinates are exact, from the first on. distance: the translation's length.
void holdExactly(int first, double distance, PosePrior& prior);
//! Throws where something is known of a coordinate that is not finite.
void checkKnown(const Pose& pose, int view, const PosePrior& prior);
//! Poses that are known: exactly, or with a covariance, in part or not at all.
std::vector<PosePrior> readPosePriors(const std::vector<Mat>& covariances, const std::vector<Pose>& poses);
//! Throws where they are given, but not used.
void checkPoseCovariances(const std::vector<Mat>& covariances, int flags);

//! LxL, PxP or (P+6)x(P+6) of each camera; noArray(): none.
std::vector<CameraPrior> readCameraPriors(const std::vector<Mat>& covariances, const std::vector<Camera>& cameras);
//! Of what all views share, 7x7, or nothing: SharedTargetErrors.
Eigen::MatrixXd readTargetCovariance(const Mat& given);

}} // namespace

#endif // OPENCV_REFRACT_FIT_PRIORS_HPP
