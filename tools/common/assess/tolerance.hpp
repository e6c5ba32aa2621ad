// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_TOLERANCE_HPP
#define REFRACT_TOOLS_TOLERANCE_HPP

#include "assess/rig_calibration.hpp"

/* The sensitivity of measured points to a wrong given value. The rig is calibrated again with the same images and the wrong value
(the free parameters absorb part of it), then points of the working volume are measured again. */
namespace tools {

struct Tolerance
{
    std::string what;               //!< "thickness + 0.1, camera 1"
    bool done = false;              //!< false: the images do not allow the fit with the wrong value
    double rms = NONE, worst = NONE;    //!< how far points move, in the unit of length
    double lengths = NONE;          //!< relative change of distances between neighbouring points of the grid, RMS
};

/** Thickness, index and wedge of the thickest layer of each window, the index of the scene's medium where it differs, and with
pairs a shift of all boards between their direct and their glass images (putting the window in moves camera or board); the
side of the board's squares, and a bow of the board. An index that was given by a material's name is wrong by what light and
kind may change it by, others by 0.001. What the images themselves determined is left out.
@param millimetre in the unit of length */
std::vector<Tolerance> analyseTolerances(const RigCalibration& calibration, double millimetre, bool quiet);

} // namespace tools

#endif // REFRACT_TOOLS_TOLERANCE_HPP
