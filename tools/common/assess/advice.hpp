// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ADVICE_HPP
#define REFRACT_TOOLS_ADVICE_HPP

#include "assess/rig_calibration.hpp"

/* Which images to take next, and how much they would improve the calibration. The covariance is known before an image is taken: it
depends on the pose of the board and not on the noise. */
namespace tools {

//! The quality of a calibration, in two numbers.
struct Quality
{
    std::vector<double> placeStd;       //!< of each window: of its normal, degrees, or of its centre; larger principal one
    double worstPoint = NONE;           //!< expected error of the worst point of the working volume, see point_error.hpp
    double calibrationPart = NONE;      //!< the part of it that better calibration removes, RMS over the volume
};

struct PlannedImage
{
    std::string placement;              //!< of the board, in words
    Quality quality;                    //!< with this image and all before it
};

struct Advice
{
    Quality now;
    bool arePairs = true;               //!< false: images through the window alone, as all that there are (a sealed housing)
    std::vector<PlannedImage> pairs;    //!< the best next pairs, one after the other
    std::vector<PlannedImage> instead;  //!< other kinds of image in place of the first, each by itself
};

Advice adviseImages(const RigCalibration& calibration);

} // namespace tools

#endif // REFRACT_TOOLS_ADVICE_HPP
