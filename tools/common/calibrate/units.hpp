// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_UNITS_HPP
#define REFRACT_TOOLS_UNITS_HPP

#include "calibrate/calib_file.hpp"

/* A length in another unit than it is taken for; angles. */
namespace tools {

const double ARC_MINUTE = CV_PI/180./60.;       //!< radians

//! The units that --unit knows.
std::vector<std::string> unitNames();

double millimetresIn(const std::string& unit);

/** The sag of a bent pane, mm per metre, by its curvature, which is over a unit of lengths: over a length L it is L^2/8 times that. */
double bowOf(double curvature, const std::string& unit);
double curvatureOf(double bow, const std::string& unit);

//! One length over another is nearly that of two units: 10, 25.4, 1000, ..., or one over that.
bool isRatioOfUnits(double ratio);

/** The same of a ratio that was measured, within the rounding of what people type: which unit a length seems to be in that should be
this many times as long; "mm", or "another unit"; empty: it is no matter of units.
@param unit that it is taken for; empty: unknown */
std::string unitSeen(double ratio, const std::string& unit);

/** Refuses a board whose square looks as if it were in another unit than that of the calibration's board, in which all
lengths come out.
@param unit of the square, as the caller says; empty: unknown. One that is the calibration's settles it */
void requireSameUnit(const Calibration& calibration, double square, const std::string& unit);

} // namespace tools

#endif // REFRACT_TOOLS_UNITS_HPP
