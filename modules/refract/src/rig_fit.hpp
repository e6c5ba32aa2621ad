// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_FIT_HPP
#define OPENCV_REFRACT_RIG_FIT_HPP

#include "poses.hpp"
#include "views.hpp"

namespace cv { namespace refract {

//! What the joint fit finds beside the cameras.
struct RigFit
{
    std::vector<Pose> poses;        //!< object -> camera 1
    double rms;
    Mat covariance, stdDeviations;  //!< of the public parameters
    Mat perViewErrors;              //!< columns: refracted, direct of each camera
    Mat jacobian;                   //!< one camera only, if wanted
};

//! Pose starts, fit, and what it tells. cameras and extrinsics are start and result.
RigFit fitRig(std::vector<Camera>& cameras, Pose& extrinsics, const RigViews& views, int flags,
              const TermCriteria& criteria, bool wantsJacobian);

void writeFit(const RigFit& fit, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, OutputArray stdDeviations,
              OutputArray covariance, OutputArray perViewErrors, OutputArray jacobian);

}} // namespace

#endif // OPENCV_REFRACT_RIG_FIT_HPP
