// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_UNSEEN_ERRORS_HPP
#define REFRACT_TOOLS_UNSEEN_ERRORS_HPP

#include "assess/check_problem.hpp"

/* What a check cannot show: a given value that was wrong in the calibration, and still is. The calibrated values have absorbed most of it,
as they would now. */
namespace tools {

struct UnseenError
{
    std::string of;             //!< "thickness"
    double least;               //!< that would show; infinity: none would
    std::string unit;           //!< empty: it has none
    bool isOfTarget = false;    //!< its size: a target of another size shows it
};

/** Each error moves the calibrated values as its source in the calibration file says; of several windows the one that shows least. First
that of the target. @param dof of the noise. @param critical probability of a gain that is a change. @param power probability with which it
must show */
std::vector<UnseenError> unseenErrors(const CheckInput& input, const CheckProblem& problem, const CheckFit& asCalibrated, double dof,
                                      double critical, double power);

} // namespace tools

#endif // REFRACT_TOOLS_UNSEEN_ERRORS_HPP
