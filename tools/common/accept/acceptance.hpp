// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ACCEPTANCE_HPP
#define REFRACT_TOOLS_ACCEPTANCE_HPP

#include "accept/gum_table.hpp"
#include "accept/lengths.hpp"

/* An acceptance test: errors of indication of calibrated lengths against what is permitted, decided with a guard band (ISO 14253-1):

    conforms:   |error| + U <= limit,       does not:   |error| - U > limit,       else undecided. */
namespace tools {

enum class Decision { PASS, FAIL, UNDECIDED };

Decision decide(double error, double U, double limit);
std::string textOf(Decision decision);

struct LengthResult
{
    CalibratedLength length;
    double measured, error, limit;
    GumTable budget;                    //!< of the error
    Decision decision;
    bool outside = false;               //!< an end is not in the calibrated volume

    double U() const { return budget.U; }
    //! What of the limit is used up, U included: above 1 it does not pass.
    double used() const { return (std::abs(error) + U())/limit; }
};

struct Acceptance
{
    TestPoints points;
    PermissibleError limit;
    std::vector<LengthResult> lengths;
    std::optional<CalibratedVolume> volume;
    std::vector<std::string> missing;   //!< against VDI/VDE 2634 part 1, half a sentence each
    std::vector<std::string> notices;   //!< what the reader should know, a sentence each
    std::string unit;
    bool imagesChecked = false;         //!< that none of them calibrated

    Decision decision() const;          //!< of all lengths: one that fails is enough, one that is undecided too
    int count(Decision decision) const;
    int outside() const;
    const LengthResult& decisive() const;       //!< that uses most of its limit
    const LengthResult& largest() const;        //!< error
    double rms() const;
};

//! Errors and decisions. @param volume in which the rig is calibrated; none: not known
Acceptance testLengths(const TestPoints& points, const PointErrors& errors, const std::vector<CalibratedLength>& lengths,
                       const PermissibleError& limit, const std::optional<CalibratedVolume>& volume);

} // namespace tools

#endif // REFRACT_TOOLS_ACCEPTANCE_HPP
