// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CAUSES_HPP
#define REFRACT_TOOLS_CAUSES_HPP

#include "diagnose/relaxed_fit.hpp"
#include "calibrate/starting_model.hpp"
#include <functional>

/* What may be wrong with a calibration that was fitted: a given value, or what is taken to be the same in direct images and in those
through the windows. Each is set free alone. */
namespace tools {

struct Cause
{
    std::string kind;                   //!< two of one kind are named once: the better
    std::vector<Shift> freed;
    std::function<std::string(const Relaxed&, double deviations)> sentence;
    bool posesToo = false;              //!< known poses are given up, nothing else
};

//! Those that this calibration can have.
std::vector<Cause> causesOf(const RigData& data, const RigOptions& options, const Fit& fit);

} // namespace tools

#endif // REFRACT_TOOLS_CAUSES_HPP
