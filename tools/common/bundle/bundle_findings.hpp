// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BUNDLE_FINDINGS_HPP
#define REFRACT_TOOLS_BUNDLE_FINDINGS_HPP

#include "bundle/bundle_adjustment.hpp"
#include "bundle/bundle_start.hpp"
#include "bundle/measures.hpp"
#include <functional>

namespace tools {

//! How far a camera's window or place is from the start, and how well it is known.
struct Correction
{
    bool estimated = false;
    double by = 0., std = 0.;           //!< of a direction or R degrees, of a centre or T lengths; std along the worst direction
};

struct CameraCorrection
{
    std::string name;                   //!< of its window's place: "normal" or "centre"
    Correction place, R, T;             //!< R and T of the first camera: nothing
    Correction axis;                    //!< a tube's
    double worstDeg = 0.;               //!< the place's std; of a centre, as seen from a radius away
};

//! What is to be thought of an adjustment.
struct BundleFindings
{
    std::vector<CameraCorrection> corrections;  //!< per camera
    std::string scale;                  //!< what tells it
    std::vector<std::string> weak;      //!< estimated, but hardly determined: name = value +- std
    std::vector<std::string> contradictions;    //!< what was known of the start, and is so no longer; a sentence each
    bool areMeasuresWrong = false;      //!< the first contradiction is of lengths or positions
    double pixelStd = 0.;               //!< px of a coordinate; where measures are wrong, without them
    double maxRms = 0.;                 //!< the limit; 0: none
    bool limitMet = true;

    bool pass() const { return limitMet && contradictions.empty(); }
    std::string verdict() const;
};

//! The same observations adjusted from another start. May throw Failure.
using Readjust = std::function<BundleAdjustment(const BundleStart& start)>;

//! What was known of a number and is contradicted by the matches, a sentence; empty: nothing is.
std::string contradictionOf(const BundleStart& start, const BundleAdjustment& adjustment, const Readjust& adjust);

/** @param measured nothing given of the scale is believed if this is there
@param knownSigma of a pixel coordinate; not above 0: unknown */
BundleFindings findingsOf(const BundleStart& start, const GivenLengths& lengths, const BundleAdjustment& adjustment,
                          const Readjust& adjust, double knownSigma, double maxRms, const MeasuredBundle* measured = nullptr);

//! What was said of where windows are, if that was not the file: against what the matches tell without it.
void checkPlaces(const BundleStart& start, const Readjust& adjust, BundleFindings& findings);

/** Which of what may change in a rig explains a contradiction, each freed alone beside what is free: the best, and those that are
as good, with "or". Empty: none does.
@param sigma the noise as it is
@param adjust the adjustment with these names free; may throw Failure */
std::string explanationOf(const std::vector<std::string>& free, double sigma,
                          const std::function<BundleAdjustment(const std::vector<std::string>&)>& adjust);

} // namespace tools

#endif // REFRACT_TOOLS_BUNDLE_FINDINGS_HPP
