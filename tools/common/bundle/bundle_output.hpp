// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BUNDLE_OUTPUT_HPP
#define REFRACT_TOOLS_BUNDLE_OUTPUT_HPP

#include "bundle/bundle_findings.hpp"
#include "console/json.hpp"
#include <iosfwd>

/* What refract_bundle writes and says. */
namespace tools {

//! points.csv, with the columns of refract_measure, and std1,std2,... where the matches have them. @param image of points without one
std::string pointsCsv(const Matches& matches, const BundleAdjustment& adjustment, const std::string& image);

//! All that the terminal says, and more of it.
Json bundleJson(const Matches& matches, const BundleAdjustment& adjustment, const BundleFindings& findings, const std::string& command,
                const std::string& unit);

//! What of it is of any rig, whatever its points are of.
Json adjustmentJson(const BundleAdjustment& adjustment, const BundleFindings& findings, const std::string& command,
                    const std::string& unit);

//! As many names as a line of 80 columns holds, and how many more there are.
std::string fittedLine(const std::string& head, const std::vector<std::string>& words);

//! How far the cameras are off the start: four lines or five; of larger rigs of the camera that is known least.
void printCorrections(std::ostream& out, const BundleFindings& findings, const std::string& unit);

//! At most ten lines of 80 columns.
void printBundle(std::ostream& out, const Matches& matches, const BundleAdjustment& adjustment, const BundleFindings& findings,
                 const std::string& unit);

} // namespace tools

#endif // REFRACT_TOOLS_BUNDLE_OUTPUT_HPP
