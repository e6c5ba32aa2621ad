// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CONDITIONS_HPP
#define REFRACT_TOOLS_CONDITIONS_HPP

#include "calibrate/calib_file.hpp"
#include "calibrate/given_std.hpp"

/* Conditions of the day: a calibration that was made in one medium is used in another. Window, lenses, R and T stay what they are, and so
does their covariance, with what the index of that time contributed to it. */
namespace tools {

class OptionParser;

//! The scene's medium.
struct Medium
{
    GivenIndex index;
    Std std;                //!< of its index
};

/** The calibration in that medium, which is the same before all its windows. The error of its index is independent of all that was
calibrated. Throws Failure if the calibration does not tell enough for it: in one medium on both sides of a window its distance has no
effect, so that it is not known. @param filename for the text */
Calibration inMedium(const Calibration& calibration, const Medium& medium, const std::string& filename);

//! --outer-index and --outer-index-std of the tools that use a calibration.
class ConditionsOptions
{
public:
    void addTo(OptionParser& parser);
    bool isSaid() const { return !index_.empty(); }
    //! Throws Failure if they are no index. @param calibration says for which light
    Medium of(const Calibration& calibration) const;
    //! The calibration as it was read, or in the medium that was said.
    Calibration appliedTo(const Calibration& calibration, const std::string& filename) const;
    //! "scene's medium: seawater:T=8,S=35, index 1.34189 +- 0.0004; calibrated in 1.33476"; empty if nothing was said.
    std::string notice(const Calibration& calibration) const;

private:
    std::string index_;
    double std_ = -1.;      //!< negative: not said
};

} // namespace tools

#endif // REFRACT_TOOLS_CONDITIONS_HPP
