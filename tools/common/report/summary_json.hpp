// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SUMMARY_JSON_HPP
#define REFRACT_TOOLS_SUMMARY_JSON_HPP

#include "assess/findings.hpp"

namespace tools {

//! All that the table and the report say, for machines; numbers that do not exist are null. Keys: doc/howto_calibrate.md.
std::string summaryJson(const RigCalibration& calibration, const Assessment& assessment, const Findings& findings,
                        const std::string& command);

} // namespace tools

#endif // REFRACT_TOOLS_SUMMARY_JSON_HPP
