// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LASER_OUTPUT_HPP
#define REFRACT_TOOLS_LASER_OUTPUT_HPP

#include "laser/scan_line.hpp"
#include "laser/sheet_fit.hpp"
#include "measure/measurement.hpp"
#include <limits>
#include <string>

/* What refract_laser says of a sheet of light, and of points on it. */
namespace tools {

//! The points of one image.
struct Scan
{
    std::string name;
    ScanLine line;
    Measurement measured;
};

//! The rows of points.csv.
std::string csvOf(const std::vector<Scan>& scans);

//! A unit after a number, with its blank; nothing where calib.yml has none.
std::string unitAfter(const std::string& unit);

//! Bent lines on flat boards: the sheet is no plane. Empty: they are straight.
std::string bendNotice(const SheetFit& fit, const std::string& unit);

//! On the terminal.
void printSheet(const SheetFit& fit, const std::vector<BoardImage>& boards, const Sheet& sheet);

//! What images have of a line at other depths than those asked for.
struct ElsewhereLine
{
    int points = 0;
    double near = std::numeric_limits<double>::infinity(), far = 0.;

    void add(const Measurement& measured);
    //! @param depth as it was asked for
    std::string text(const std::string& depth) const;
};

} // namespace tools

#endif // REFRACT_TOOLS_LASER_OUTPUT_HPP
