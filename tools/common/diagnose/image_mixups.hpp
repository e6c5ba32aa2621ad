// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_IMAGE_MIXUPS_HPP
#define REFRACT_TOOLS_IMAGE_MIXUPS_HPP

#include "diagnose/calibration_input.hpp"
#include <functional>

/* Images that are turned, mirrored or of another camera, found without a fit, in milliseconds: each of these is undone, and it is the
cause if then pairs show the board nearly where it was, and two cameras' boards agree on where the cameras are to each other. */
namespace tools {

struct MixUp
{
    std::string sentence;
    std::function<RigData()> undone;    //!< makes the images as they should be, of the input, which has to live
    double camerasApart;                //!< then, px: see Disagreements
};

struct MixUps
{
    std::vector<MixUp> clear;           //!< those that make the images agree best, if any makes them agree clearly better
    double camerasApart = 0.;           //!< of the images as given, px: see Disagreements; 0 where all kinds agree
    std::vector<MixUp> possible;        //!< others that make them agree no worse, the best first: tilted windows in water hide an exchange
};

MixUps findMixUps(const CalibrationInput& input);

/** Throws Failure if of two cameras that only images through their windows calibrate some are not of one moment, or exchanged. Their
lenses are searched for half a minute, and with such images for longer. */
void requireOneMoment(const CalibrationInput& input);

} // namespace tools

#endif // REFRACT_TOOLS_IMAGE_MIXUPS_HPP
