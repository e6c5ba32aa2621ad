// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ADVICE_HPP
#define REFRACT_TOOLS_ADVICE_HPP

#include "assess/rig_calibration.hpp"

/* Which images to take next, and what they would bring: the covariance is known before an image is taken, as it depends on
where the board is and not on what the noise will be. */
namespace tools {

//! What the calibration is worth, in the two numbers that matter.
struct Worth
{
    std::vector<double> normalStdDeg;   //!< of each window, larger principal one
    double worstPoint = NONE;           //!< expected error of the worst point of the working volume, see point_error.hpp
    double calibrationPart = NONE;      //!< the part of it that better calibration removes, RMS over the volume
};

struct Shot
{
    std::string words;                  //!< where to hold the board
    Worth worth;                        //!< with this image and all before it
};

struct Advice
{
    Worth now;
    std::vector<Shot> pairs;            //!< the best next pairs, one after the other
    std::vector<Shot> instead;          //!< other kinds of image in place of the first, each alone
};

Advice adviseImages(const RigCalibration& calibration);

} // namespace tools

#endif // REFRACT_TOOLS_ADVICE_HPP
