// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FINDINGS_HPP
#define REFRACT_TOOLS_FINDINGS_HPP

#include "assess/advice.hpp"
#include "assess/budget.hpp"
#include "console/table.hpp"
#include "diagnose/hypothesis_tests.hpp"
#include "measure/point_error.hpp"

namespace tools {

/* The quality of a calibration: the errors of measured points, what they are made of, the gain of the next images. */

struct Assessment
{
    std::vector<ErrorMap> errors;           //!< from half the nearest to twice the farthest board
    std::vector<ErrorMap> limits;           //!< at the ranges of Limits::errors
    std::vector<BudgetRow> budget;
    Advice advice;
    std::vector<Contradiction> contradictions;
};

Assessment assess(const RigCalibration& calibration);

//! A limit that the caller set, and the value to compare with it.
struct LimitCheck
{
    std::string option, what;       //!< "--max-rms=0.3", "RMS over all corners"
    double limit, value;            //!< value NaN: unknown, which does not meet the limit
    std::string unit;
    std::string notJudged = "";     //!< why no value could meet it; empty: values do

    bool met() const { return notJudged.empty() && value <= limit; }
    std::string sentence() const;
};

//! The result for a technician, in sentences.
struct Findings
{
    std::vector<LimitCheck> limits;
    std::vector<std::string> contradictions;    //!< between the images and given values
    std::vector<std::string> weak;          //!< weak points, and how to improve them; what puts more in doubt first
    std::vector<std::string> cannotTell;    //!< what these data do not determine
    std::vector<std::string> assumed;       //!< taken as exact
    std::string notChecked;                 //!< why held-out boards do not test the +-; empty: they do

    bool pass() const;              //!< all limits are met, and nothing is contradicted
    Tone tone() const;              //!< DOUBTFUL: there are weak points, or the +- is not checked
    //! PASS or FAIL if there are limits, otherwise in words; beside PASS what it does not say.
    std::string verdict() const;
};

Findings findingsOf(const RigCalibration& calibration, const Assessment& assessment);

//! What to do with the result: correct a value, take images, know a value better, or measure. Half a sentence.
std::string nextStep(const RigCalibration& calibration, const Assessment& assessment, const Findings& findings);

} // namespace tools

#endif // REFRACT_TOOLS_FINDINGS_HPP
