// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BUNDLE_START_HPP
#define REFRACT_TOOLS_BUNDLE_START_HPP

#include "bundle/matches.hpp"
#include "calibrate/given_places.hpp"
#include "calibrate/given_std.hpp"
#include "calibrate/given_window.hpp"
#include "calibrate/rig_model.hpp"
#include <functional>

/* What a bundle adjustment starts from, and what is known beforehand. */
namespace tools {

/* What is known of a rig before its matches: a covariance of all its parameters, in which a row of zeros is exact, or free. */

/** Of nominal values, as well as a data sheet knows them, as in refract_calib; the rig gets the wedges and the bow that are estimated
within that.
@param of how well the values of a window are given */
cv::Mat covarianceOfGiven(const std::function<GivenStd(const cv::refract::GlassWindow&)>& of, int flags, RigModel& rig);

//! What is free again: the earlier calibration has no say. @param free names of --free
void forget(const std::vector<std::string>& free, const RigModel& rig, cv::Mat& covariance);

struct BundleOptions
{
    std::vector<std::string> free;      //!< --free; empty: not said
    GivenWindowOptions window;          //!< of a start that has none
    GivenStdOptions std;
    GivenPlaces places;                 //!< of flat windows, where the file does not know
    std::string unit;                   //!< of lengths; empty: not said
    bool noWindow = false;
};

struct BundleStart
{
    RigModel rig;
    int flags = 0;                      //!< what the matches alone must tell
    cv::Mat covariance;                 //!< of what is estimated within what is known of it; in the order of calibrateGlassRig's
    std::vector<std::string> free;      //!< names of what the flags say
    std::string placeOption = {};       //!< what said where windows are; empty: the file
};

//! What --free takes.
std::vector<std::string> freeNames();

/** Three kinds of parameters: what --free names starts at the file's values and follows from the matches alone; what has a
variance in the file, or a --...-std where the file has none, is estimated within that; the rest is exact. Throws Failure where
options and file do not go together. */
BundleStart startOf(Calibration file, const std::string& path, const BundleOptions& options);

/** Throws Failure if nothing tells the scale, or if the lengths, measured with the start, look as if they were in another unit. */
void requireScale(const BundleStart& start, const std::string& path, const Matches& matches, const GivenLengths& lengths);

} // namespace tools

#endif // REFRACT_TOOLS_BUNDLE_START_HPP
