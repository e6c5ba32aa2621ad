#ifndef REFRACT_TOOLS_SUMMARY_HPP
#define REFRACT_TOOLS_SUMMARY_HPP

#include "findings.hpp"
#include <iosfwd>

namespace tools {

//! One line of the summary: a name and a cell for each camera.
struct SummaryRow
{
    std::string name;
    std::vector<std::string> cells;
};

//! What was found, with one standard deviation, and how well it fits. The same in the terminal and in the report.
std::vector<SummaryRow> windowRows(const RigCalibration& calibration);
std::vector<SummaryRow> fitRows(const RigCalibration& calibration);

//! The summary table and the findings, for a terminal.
void printSummary(std::ostream& out, const RigCalibration& calibration, const Findings& findings);

//! For the file.
Calibration toFile(const RigCalibration& calibration, const std::string& command);

} // namespace tools

#endif // REFRACT_TOOLS_SUMMARY_HPP
