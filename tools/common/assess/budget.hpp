// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BUDGET_HPP
#define REFRACT_TOOLS_BUDGET_HPP

#include "assess/rig_calibration.hpp"

/* The uncertainty budget of a measured point (GUM, JCGM 100:2008, 5.1): what each source contributes to its +-. */
namespace tools {

const char* const CALIBRATION_NOISE = "noise of the calibration's images";

struct BudgetRow
{
    std::string source;             //!< "thickness, camera 1"
    std::string given;              //!< its standard uncertainty, as given; empty: the images themselves
    double effect = NONE;           //!< on points of the working volume, RMS of the 3-D standard deviations, in the unit of length
    double share = NONE;            //!< of the sum of the squares
};

/** What each given value contributes to the covariance of the calibration: with the covariance C of all that is estimated and the
information W of the value, C W C, of which the factor is C W^(1/2). */
std::vector<UncertaintySource> uncertaintySources(const RigCalibration& calibration);

/** The rows add up to the last one, the total, in squares. */
std::vector<BudgetRow> uncertaintyBudget(const RigCalibration& calibration);

} // namespace tools

#endif // REFRACT_TOOLS_BUDGET_HPP
