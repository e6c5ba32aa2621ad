// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_HYPOTHESIS_TESTS_HPP
#define REFRACT_TOOLS_HYPOTHESIS_TESTS_HPP

#include "calibrate/fit.hpp"
#include "calibrate/starting_model.hpp"

/* Tests of the hypothesis that a given value is right (thickness, index, distance, index of the scene's medium, wedge, exact poses).
Each is set free in turn, all else as in the calibration. If the estimate is further from the given value than both standard deviations
explain, the images contradict the given value, and the stated +- of everything that depends on it is too small. */
namespace tools {

//! A given value that the images contradict.
struct Contradiction
{
    std::string sentence;       //!< which value, and its estimate
    double sigma;               //!< of a pixel coordinate, of the fit with the value free
    bool isSure = true;         //!< false: too few standard deviations to decide
    double singleImages = 0.;   //!< px, the same with a pose for each image alone: what no wrong value hides in
};

//! The one with the best fit first; others only if they fit about as well.
std::vector<Contradiction> testGivenValues(const RigData& data, const RigOptions& options, const Fit& fit);

const double PROMISING = 0.025;         //!< probability of its gain, to first order, if nothing is wrong: below, a hypothesis is fitted
const double CERTAIN = 2e-9;            //!< probability, if nothing is wrong, below which a calibration is refused

//! What a cause explains, set free alone: distributed as chi^2 if nothing is wrong.
struct CauseTest
{
    std::string kind;
    double deviance;
    int parameters;
};

//! Of all causes that promise to explain anything.
std::vector<CauseTest> testCauses(const RigData& data, const RigOptions& options, const Fit& fit);

} // namespace tools

#endif // REFRACT_TOOLS_HYPOTHESIS_TESTS_HPP
