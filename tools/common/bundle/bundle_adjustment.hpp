// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BUNDLE_ADJUSTMENT_HPP
#define REFRACT_TOOLS_BUNDLE_ADJUSTMENT_HPP

#include "bundle/bundle_start.hpp"
#include "calibrate/fit.hpp"
#include <functional>
#include <map>

namespace tools {

//! Cameras, windows, places and points that fit the matches best.
struct BundleAdjustment
{
    Fit fit;                            //!< rig, covariance, rms, sigma, dof; no views
    std::vector<double> rmsOfCamera;    //!< px
    std::vector<cv::Point3d> points;    //!< of Matches::names, in camera 1; NaN: no answer
    std::vector<cv::Vec3d> sigma;       //!< of the same
    std::vector<uchar> status;          //!< of the same, as Measurement::status
    std::vector<std::vector<uchar>> used;   //!< per camera, per point; of a survey: one list, of its observations
    int usedPixels = 0, seenPixels = 0; //!< of points that two cameras saw
    double squaredPixels = 0.;          //!< px^2, of what is used, each over its relative variance
    double squaredKnown = 0.;           //!< of lengths, positions and what was known, over their variances
    std::map<int, cv::Vec3d> places;    //!< where views are of which positions are known

    //! Squares over variances, less what they are expected to be: pixels that are left out have none. @param sigma of a pixel
    double costAt(double sigma) const { return squaredPixels/(sigma*sigma) - 2.*usedPixels + squaredKnown; }
    int answers() const;
    std::vector<int> outliers() const;  //!< points with a pixel that no point explains
};

const int ENOUGH_ITERATIONS = 100;      // of a fit that asks what is wrong: a right start needs no more

//! Throws Failure that says what the matches do not determine, or why there is no answer.
BundleAdjustment adjustBundle(const BundleStart& start, const Matches& matches, const GivenLengths& lengths, bool robust,
                              int iterations = 1000);

/** Runs what adjusts. Throws Failure that says what was found, then what to do here. */
void adjustOrExplain(const std::function<void()>& adjust);

//! BundleAdjustment::squaredKnown, without that of positions.
double squaredKnown(const BundleStart& start, const GivenLengths& lengths, const BundleAdjustment& result);

//! As a file of it, with the label of the start; without its unit.
Calibration toFile(const BundleAdjustment& adjustment, const Calibration& start);

} // namespace tools

#endif // REFRACT_TOOLS_BUNDLE_ADJUSTMENT_HPP
