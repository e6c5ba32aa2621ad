// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_HELDOUT_TEST_HPP
#define REFRACT_TOOLS_HELDOUT_TEST_HPP

#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"

namespace tools {

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

} // namespace tools

#endif // REFRACT_TOOLS_HELDOUT_TEST_HPP
