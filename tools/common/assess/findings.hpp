// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FINDINGS_HPP
#define REFRACT_TOOLS_FINDINGS_HPP

#include "assess/assessment.hpp"

namespace tools {

//! A limit that the caller set, and what there is instead.
struct LimitCheck
{
    std::string option, what;       //!< "--max-rms=0.3", "RMS over all corners"
    double limit, value;            //!< value NaN: there is none, which does not meet the limit
    std::string unit;

    bool met() const { return value <= limit; }
    std::string sentence() const;
};

//! What a technician must know, in sentences.
struct Findings
{
    std::vector<LimitCheck> limits;
    std::vector<std::string> contradictions;    //!< between the images and what was given
    std::vector<std::string> weak;          //!< to be mended, and how
    std::vector<std::string> cannotTell;    //!< what these data do not say
    std::vector<std::string> assumed;       //!< taken as given
    std::string notChecked;                 //!< why no held-out board says whether the +- is true; empty: they do

    bool pass() const;              //!< all limits are met
    std::string verdict() const;    //!< PASS or FAIL where there are limits, otherwise in words
};

Findings judge(const RigCalibration& calibration, const Assessment& assessment);

} // namespace tools

#endif // REFRACT_TOOLS_FINDINGS_HPP
