// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FIT_HPP
#define REFRACT_TOOLS_FIT_HPP

#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"
#include "calibrate/starting_model.hpp"
#include <opencv2/refract.hpp>

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
    double dof = 0.;                            //!< degrees of freedom: coordinates and what is known - what is estimated
    double sigma = 0.;                          //!< of a pixel coordinate, from the residuals: what all +- are multiples of
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

/* The joint fit of windows, rig and board poses to the images. Geometry is the library's. */

const int MAX_ITERATIONS = 1000, MAX_ROBUST_ITERATIONS = 100;     // the latter in each of many rounds

//! What a calibration and a bundle adjustment of the library tell alike.
template<class Result>
void setEstimate(const Result& result, Fit& fit)
{
    fit.rms = result.rms;
    fit.sigma = result.pixelStd;
    fit.dof = result.degreesOfFreedom;
    fit.stdDeviations = result.stdDeviations;
    fit.covariance = result.covariance;
}

//! calibrateGlassRig on some of the views.
Fit fitImages(const RigData& data, const RigModel& start, const std::vector<int>& views, int flags,
              int maxIterations = MAX_ITERATIONS);

/** Whether the next fits of these images may start where this one ended, without a search: only images through windows tell where several
cameras are, which takes seconds to search, and that search met no other plausible minimum. */
bool isOnlyMinimum(const RigData& data, const Fit& fit, int flags);

/** One fit of all images: lenses that came from images are free in it, so that their uncertainty is in every +-; direct
images are views too, each with its own pose. The windows are found first, with the lenses held.
@param flags gets GLASS_FREE_INTRINSICS if so
@param isPlaced the initial values are placed as an earlier fit has them, and no other minimum is looked for */
Fit fitAllImages(const RigData& data, const RigModel& start, const std::vector<LensSource>& lensSources, int& flags,
                 int maxIterations = MAX_ITERATIONS, bool isPlaced = false);

} // namespace tools

#endif // REFRACT_TOOLS_FIT_HPP
