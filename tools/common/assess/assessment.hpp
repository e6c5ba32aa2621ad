// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ASSESSMENT_HPP
#define REFRACT_TOOLS_ASSESSMENT_HPP

#include "assess/advice.hpp"
#include "assess/budget.hpp"
#include "diagnose/hypothesis_tests.hpp"
#include "measure/point_error.hpp"

/* The quality of a calibration: the errors of measured points, what they are made of, the gain of the next images. */
namespace tools {

struct Assessment
{
    std::vector<ErrorMap> errors;           //!< from half the nearest to twice the farthest board
    std::vector<ErrorMap> limits;           //!< at the ranges of Limits::errors
    std::vector<BudgetRow> budget;
    Advice advice;
    std::vector<Contradiction> contradictions;
};

Assessment assess(const RigCalibration& calibration);

} // namespace tools

#endif // REFRACT_TOOLS_ASSESSMENT_HPP
