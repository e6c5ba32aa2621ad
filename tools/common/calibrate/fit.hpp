// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FIT_HPP
#define REFRACT_TOOLS_FIT_HPP

#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"

namespace tools {

//! The result of one joint fit.
struct Fit
{
    RigModel rig;
    std::vector<int> views;                     //!< that took part, as indices into RigData::views
    std::vector<cv::Vec3d> rvecs, tvecs;        //!< board -> camera 1, of each of them
    cv::Mat stdDeviations, covariance;          //!< of cameras and their places
    cv::Mat withTargets;                        //!< the covariance, with these errors at its end where they are estimated
    cv::Mat imageStatus;                        //!< GlassImageStatus; a row each: direct 1, glass 1, direct 2, ...
    std::vector<cv::Mat> inliers;               //!< of each of these, row by row: which points were used
    cv::Mat otherMinima;                        //!< a row each camera, see calibrateGlassRig
    double rms = 0.;
    double dof = 0.;                            //!< degrees of freedom: coordinates - free parameters - 6 for each unknown pose
    double sigma = 0.;                          //!< of a pixel coordinate, from the residuals
};

//! One observed corner: where it was seen, and seen minus modelled.
struct Residual
{
    int camera, view;
    bool glass;
    cv::Point2d pixel, error;
};

//! All corners of the views that took part.
std::vector<Residual> residualsOf(const RigData& data, const Fit& fit);

//! Board -> camera `camera` of the k-th view of a fit.
void poseInCamera(const Fit& fit, size_t k, int camera, cv::Vec3d& rvec, cv::Vec3d& tvec);

} // namespace tools

#endif // REFRACT_TOOLS_FIT_HPP
