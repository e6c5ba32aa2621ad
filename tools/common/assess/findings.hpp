// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FINDINGS_HPP
#define REFRACT_TOOLS_FINDINGS_HPP

#include "assess/assessment.hpp"
#include "console/colour.hpp"

namespace tools {

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

} // namespace tools

#endif // REFRACT_TOOLS_FINDINGS_HPP
