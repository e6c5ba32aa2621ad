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

//! Cells: std of the normals, worst point, the calibration's part.
std::vector<SummaryRow> adviceRows(const Advice& advice);

//! Verdict, tables and findings, for a terminal.
void printSummary(std::ostream& out, const RigCalibration& calibration, const Assessment& assessment,
                  const Findings& findings);

//! For the file.
Calibration toFile(const RigCalibration& calibration, const std::string& command);

//! All that the table and the report say, for machines; numbers that do not exist are null. Keys: doc/howto_calibrate.md.
std::string summaryJson(const RigCalibration& calibration, const Assessment& assessment, const Findings& findings,
                        const std::string& command);

/** What was given and not left to the images alone: each value, how well it is known, and who said so. Cells: value, one standard
deviation, source. */
std::vector<SummaryRow> givenRows(const RigCalibration& calibration);

//! One self-contained HTML page by which a technician can assess the calibration.
std::string makeReport(const RigCalibration& calibration, const Assessment& assessment, const Findings& findings,
                       const std::string& commandLine, bool quiet);

/* A terminal shows them without scrolling, and a photograph of it can be read. */
const size_t DIGEST_LINES = 10, DIGEST_COLUMNS = 80;

/** The result in so many lines: the verdict and its reasons, the error of a measured point at three ranges, what to do next. What
does not fit is counted, and the tables have it. @param report its file; empty: none */
void printDigest(std::ostream& out, const RigCalibration& calibration, const Assessment& assessment, const Findings& findings,
                 const std::string& report);

} // namespace tools

#endif // REFRACT_TOOLS_SUMMARY_HPP
