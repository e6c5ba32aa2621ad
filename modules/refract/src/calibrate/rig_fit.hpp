// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_FIT_HPP
#define OPENCV_REFRACT_RIG_FIT_HPP

#include "calibrate/rig_problem.hpp"

namespace cv { namespace refract {

//! What the calibrators are given beside the cameras.
struct RigTask
{
    RigViews views;
    std::vector<Pose> knownPoses;               //!< GLASS_USE_POSES: one per view, else empty
    std::vector<PoseKnowledge> knowledge;       //!< of the same
    std::vector<CameraKnowledge> cameras;       //!< one per camera, or empty
    int flags;
    TermCriteria criteria;
    bool wantsJacobian = false;
};

//! What the joint fit finds beside the cameras.
struct RigFit
{
    std::vector<Pose> poses;        //!< object -> camera 1; NaN where a view has no point left
    double rms;
    Mat covariance, stdDeviations;  //!< of the public parameters
    Mat perViewErrors;              //!< columns: direct, refracted of each camera
    Mat jacobian;                   //!< if wanted
    Mat imageStatus;                //!< GlassImageStatus, as perViewErrors
    std::vector<Mat> inliers;       //!< of each element of perViewErrors, row by row
    Mat otherMinima;                //!< one row a camera: normal, excess, distance
};

//! Both limits in force: what the caller left open is generous.
TermCriteria checkedCriteria(TermCriteria criteria);

//! Starts, fit, and what it tells. rig is start and result.
RigFit fitRig(Rig& rig, const RigTask& task);

//! What all calibrators return; copies what is wanted.
void writeFit(const RigFit& fit, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, OutputArray stdDeviations,
              OutputArray covariance, OutputArray perViewErrors);
void writeMat(const Mat& from, OutputArray to);

}} // namespace

#endif // OPENCV_REFRACT_RIG_FIT_HPP
