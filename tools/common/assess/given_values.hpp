// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_GIVEN_VALUES_HPP
#define REFRACT_TOOLS_GIVEN_VALUES_HPP

#include "assess/rig_calibration.hpp"

/* Do the images contradict what was given? Each given value (thickness, index, distance, index of the scene's medium, exact poses) is set
free in turn, all else as in the calibration: where the images put it many of its standard deviations away, the stated +- of
everything that rests on the given value is not true. */
namespace tools {

//! A given value that the images contradict.
struct Contradiction
{
    std::string sentence;       //!< which, and what it would be
    double sigma;               //!< of a pixel coordinate where it is set free
};

//! The best first, and only those that make the images agree about as well as that.
std::vector<Contradiction> contradictedValues(const RigCalibration& calibration);

} // namespace tools

#endif // REFRACT_TOOLS_GIVEN_VALUES_HPP
