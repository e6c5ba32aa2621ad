// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CROSS_VALIDATION_HPP
#define REFRACT_TOOLS_CROSS_VALIDATION_HPP

#include "assess/baselines.hpp"
#include "calibrate/fit.hpp"
#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"

/* Cross-validation: the errors of a calibration on images that it was not fitted to. Lens, window and rig are fitted to some of the
views; the others are held out. A lens that is not part of the fit (given, or from direct images alone) stays. And the influence of single
views on the result. */
namespace tools {

//! How far the window of each camera turns (degrees), or a dome's centre moves, if one view is left out: see placeChange.
struct Influence
{
    int view;
    std::vector<double> change;     //!< of each camera's window; NaN: not determined without it
};

//! Views with a glass image; empty if there are fewer than three.
std::vector<Influence> leaveOneOut(const RigData& data, const Fit& fit, int flags, bool quiet);

/** Whether the residuals of held-out views are as large as the calibration's covariance says. The pose of each board is fitted, as it
is unknown:

    r = Q^T (pixels - predicted),   S = sigma^2 I + A C A^T,   A = Q^T byParameters,   Q: null space of the poses

Most of r is pixel noise, for any calibration. The calibration's errors show in the few directions in which A C A^T is larger than
sigma^2: these test whether C is right. */
struct HeldOutTest
{
    double squares = 0., expectedSquares = 0.;          //!< of all of r, px^2
    double chiSquare = 0.;      //!< of r in the directions of the calibration's errors
    int directions = 0;         //!< their number

    void add(const HeldOutTest& other);
    double ratio() const;               //!< RMS over expected RMS; NaN: nothing was added
    double calibrationRatio() const;    //!< root of chiSquare per direction: 1 where C is right; NaN: no direction
};

//! Throws Failure if no pose of the target explains its points.
HeldOutTest testHeldOut(const RigModel& rig, const cv::Mat& covariance, double sigma, const std::vector<View>& views);

/** Each view with a glass image is held out once, and the calibration is fitted to the others. NaN: not applicable. */
struct HeldOut
{
    int folds = 0;                  //!< 0: not done
    int views = 0, failed = 0;      //!< views held out; those without which the window was not determined
    double px = NONE;               //!< RMS through the window, the board's pose fitted to the one image
    double pinholePx = NONE;        //!< the same for a pinhole calibrated through the glass
    HeldOutTest covarianceTest;     //!< of all images of the views, over all folds: errors against the stated covariance
    double transferPx = NONE;       //!< RMS through the window, the board's pose from the direct image of the pair alone
    double lengthRms = NONE;        //!< several cameras: distances of neighbouring corners, triangulated minus true, RMS
    double lengthMean = NONE;
    double pinholeLengthRms = NONE; //!< the same for a pinhole rig calibrated through the glass
};

HeldOut holdOut(const RigData& data, const Fit& fit, int flags);

/** Calibrated on the boards of one half of the range, tested on the other. A central camera fitted through the glass
absorbs the window at the range it was calibrated at, and nowhere else. */
struct NearFar
{
    bool done = false;              //!< false: too few images through the window
    double nearRange[2], farRange[2];                       //!< board distance from camera 1, from - to
    double windowNearToFar = NONE, windowFarToNear = NONE;  //!< RMS px on the half not used
    double pinholeNearToFar = NONE, pinholeFarToNear = NONE;
};

NearFar nearAgainstFar(const RigData& data, const Fit& fit, int flags);

} // namespace tools

#endif // REFRACT_TOOLS_CROSS_VALIDATION_HPP
