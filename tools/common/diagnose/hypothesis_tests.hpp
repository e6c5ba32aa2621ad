// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_HYPOTHESIS_TESTS_HPP
#define REFRACT_TOOLS_HYPOTHESIS_TESTS_HPP

#include "calibrate/fit.hpp"
#include "calibrate/starting_model.hpp"
#include <string>
#include <vector>

/* Tests of the hypothesis that a given value is right (thickness, index, distance, index of the scene's medium, wedge, exact poses).
Each is set free in turn, all else as in the calibration. If the estimate is further from the given value than both standard deviations
explain, the images contradict the given value, and the stated +- of everything that depends on it is too small. */
namespace tools {

/* Which of several hypotheses explains observations that contradict a calibration. Each gives up one assumption and is fitted to the
same observations. They are compared by Schwarz's criterion (BIC; Annals of Statistics 6, 1978)

    chi^2 / sigma^2 + k log(n)

of n observations and k parameters set free, where sigma is the noise that the best of them leaves. */

struct Hypothesis
{
    double squares;             //!< sum of squares, px^2, of the residuals and of what priors add; infinity: no fit
    int parameters;             //!< set free, beside those of the fit as given
};

/** Which hypotheses explain the observations, the best first; others only if they explain about as much. Empty if none is clearly better
than nothing wrong (a difference of 10, "very strong evidence" of Kass and Raftery, JASA 90, 1995).
@param asGiven the fit with nothing given up. @param observations their number (two a point)
@param noise px, the least standard deviation that a coordinate of these observations can have; 0: not known */
std::vector<size_t> rank(const Hypothesis& asGiven, const std::vector<Hypothesis>& tried, int observations, double noise);

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
