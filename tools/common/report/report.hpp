// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_REPORT_HPP
#define REFRACT_TOOLS_REPORT_HPP

#include "assess/findings.hpp"

namespace tools {

//! One self-contained HTML page by which a technician can assess the calibration.
std::string makeReport(const RigCalibration& calibration, const Assessment& assessment, const Findings& findings,
                       const std::string& commandLine, bool quiet);

} // namespace tools

#endif // REFRACT_TOOLS_REPORT_HPP
