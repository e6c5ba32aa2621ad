// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DIGEST_HPP
#define REFRACT_TOOLS_DIGEST_HPP

#include "assess/findings.hpp"
#include <iosfwd>

namespace tools {

/* A terminal shows them without scrolling, and a photograph of it can be read. */
const size_t DIGEST_LINES = 10, DIGEST_COLUMNS = 80;

/** The result in so many lines: the verdict and its reasons, the error of a measured point at three ranges, what to do next. What
does not fit is counted, and the tables have it. @param report its file; empty: none */
void printDigest(std::ostream& out, const RigCalibration& calibration, const Assessment& assessment, const Findings& findings,
                 const std::string& report);

} // namespace tools

#endif // REFRACT_TOOLS_DIGEST_HPP
