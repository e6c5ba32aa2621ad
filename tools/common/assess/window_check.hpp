// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_WINDOW_CHECK_HPP
#define REFRACT_TOOLS_WINDOW_CHECK_HPP

#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"

/* Has a window moved since the calibration? From a few new images of the target:

    pixels - predicted = A dp + B delta + K dpose + noise

p are the calibrated parameters, whose error dp has the calibration's covariance C; delta is the tilt of each window since
then; the boards' poses are free. With the poses projected out, generalised least squares with S = sigma^2 I + A C A^T gives
delta and its covariance V, and under "unchanged" delta^T V^-1 delta / 2 follows F with 2 and the calibration's degrees of
freedom, as sigma (and with it C) is itself an estimate. Two windows: each is tested at half the false-alarm rate. */
namespace tools {

//! What the test starts from.
struct CheckInput
{
    RigModel rig;
    cv::Mat covariance;         //!< of its parameters, as Fit::covariance; empty: they are exact
    double sigma;               //!< of a pixel coordinate
    double dof;                 //!< degrees of freedom of sigma
};

struct WindowCheck
{
    int camera;
    cv::Vec3d normal;           //!< as it is now
    double tiltDeg;             //!< between the calibrated normal and this
    double stdDeg[2];           //!< of the tilt, two principal ones, larger first
    double probability;         //!< of so large a tilt or a larger one if nothing moved
    bool moved;
};

struct CheckResult
{
    std::vector<WindowCheck> windows;   //!< of the cameras that have a glass image
    double sigmaSeen;                   //!< of the new images, after the windows were let go
    double residualProbability;         //!< of residuals as large as these or larger if only the windows could have moved
};

//! Throws Failure if no view has an image through a window, or a target's pose cannot be found.
CheckResult checkTilts(const CheckInput& input, const std::vector<View>& views, double falseAlarm);

/** Probability that a tilt of this size, in the direction in which it shows least, is found.
@param share of the covariance: 1/2 for twice as many images */
double powerOf(const WindowCheck& window, size_t windowCount, double dof, double falseAlarm, double tiltDeg,
               double share = 1.);

} // namespace tools

#endif // REFRACT_TOOLS_WINDOW_CHECK_HPP
