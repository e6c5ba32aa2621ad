// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_COLLECTED_FINDINGS_HPP
#define REFRACT_TOOLS_COLLECTED_FINDINGS_HPP

#include "assess/findings.hpp"
#include <map>

/* Findings while they are collected: each function looks at one part of a calibration, and adds what it finds. */
namespace tools {

//! What a weak point puts in doubt; the first is told first.
enum Doubt { THE_STATED_ERROR, THE_FIT, THE_DATA, A_PARAMETER, AN_IMAGE };

//! Findings, and their weak points by what these put in doubt.
struct CollectedFindings : Findings
{
    std::multimap<Doubt, std::string> doubts;

    void add(Doubt doubt, const std::string& sentence) { doubts.emplace(doubt, sentence); }
};

//! "camera 2: " where there are several.
std::string prefixOf(const RigCalibration& calibration, int camera);

//! What the faces of the windows are taken to be, in a word.
std::string shapeWords(const RigCalibration& calibration);

//! What is hardly known of a camera's window.
void checkWindow(const RigCalibration& calibration, int camera, CollectedFindings& findings);
//! Parameters of windows that images tell together only.
void checkCorrelations(const RigCalibration& calibration, Findings& findings);
//! What was taken as exact.
void checkAssumptions(const RigCalibration& calibration, Findings& findings);

} // namespace tools

#endif // REFRACT_TOOLS_COLLECTED_FINDINGS_HPP
