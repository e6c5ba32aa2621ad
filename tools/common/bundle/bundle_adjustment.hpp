// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BUNDLE_ADJUSTMENT_HPP
#define REFRACT_TOOLS_BUNDLE_ADJUSTMENT_HPP

#include "bundle/bundle_start.hpp"
#include "calibrate/fit.hpp"
#include <functional>

namespace tools {

//! Cameras, windows, places and points that fit the matches best.
struct BundleAdjustment
{
    Fit fit;                            //!< rig, covariance, rms, sigma, dof; no views
    std::vector<double> rmsOfCamera;    //!< px
    std::vector<cv::Point3d> points;    //!< of Matches::names, in camera 1; NaN: no answer
    std::vector<cv::Vec3d> sigma;       //!< of the same
    std::vector<uchar> status;          //!< of the same, as Measurement::status
    std::vector<std::vector<uchar>> used;   //!< per camera, per point
    int usedPixels = 0, seenPixels = 0; //!< of points that two cameras saw
    double squaredPixels = 0.;          //!< px^2, of what is used, each over its relative variance
    double squaredKnown = 0.;           //!< of lengths and what was known, over their variances

    int answers() const;
    std::vector<int> outliers() const;  //!< points with a pixel that no point explains
};

//! Throws Failure that says what the matches do not determine, or why there is no answer.
BundleAdjustment adjustBundle(const BundleStart& start, const Matches& matches, const GivenLengths& lengths, bool robust,
                              int iterations = 1000);

/** Runs what adjusts. Throws Failure that says what was found, then what to do here. */
void adjustOrExplain(const std::function<void()>& adjust);

/** The standard deviation of a usual pixel, and the degrees of freedom that tell it; lengths and what was known are equations, too.
@param squaredPixels of all that are used, each over its relative variance
@param unknownPoses numbers that say where views are, beside what is known of them */
void setNoise(const BundleStart& start, const GivenLengths& lengths, double squaredPixels, int unknownPoses, BundleAdjustment& result);

//! As a file of it, with the label of the start; without its unit.
Calibration toFile(const BundleAdjustment& adjustment, const Calibration& start);

} // namespace tools

#endif // REFRACT_TOOLS_BUNDLE_ADJUSTMENT_HPP
