// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SUMMARY_HPP
#define REFRACT_TOOLS_SUMMARY_HPP

#include "assess/findings.hpp"
#include <iosfwd>

namespace tools {

//! One line of the summary: a name and a cell for each camera.
struct SummaryRow
{
    std::string name;
    std::vector<std::string> cells;
};

//! The estimates with one standard deviation, and how well they fit. The same in the terminal and in the report.
std::vector<SummaryRow> windowRows(const RigCalibration& calibration);
std::vector<SummaryRow> fitRows(const RigCalibration& calibration);

//! On held-out boards; cells: lens and window, a pinhole calibrated through the glass.
std::vector<SummaryRow> heldOutRows(const RigCalibration& calibration);

//! Expected error of a measured point; cells: half of the image within, 95 % within, worst, worst of pixel noise alone, seen.
std::vector<SummaryRow> pointErrorRows(const RigCalibration& calibration, const Assessment& assessment);

//! How to read them.
std::string pointErrorNote(const RigCalibration& calibration, const Assessment& assessment);

//! Cells: to what the source is known, its effect, its share in per cent.
std::vector<SummaryRow> budgetRows(const Assessment& assessment);

//! Cells: points RMS, worst point, lengths in parts of a thousand.

//! Cells: std of the normals, worst point, the calibration's part.
std::vector<SummaryRow> adviceRows(const Advice& advice);

//! Verdict, tables and findings, for a terminal.
void printSummary(std::ostream& out, const RigCalibration& calibration, const Assessment& assessment,
                  const Findings& findings);

//! For the file.
Calibration toFile(const RigCalibration& calibration, const std::string& command);

} // namespace tools

#endif // REFRACT_TOOLS_SUMMARY_HPP
