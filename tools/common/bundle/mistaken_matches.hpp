// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MISTAKEN_MATCHES_HPP
#define REFRACT_TOOLS_MISTAKEN_MATCHES_HPP

#include "bundle/bundle_findings.hpp"

namespace tools {

/** Whether what two cameras saw is given as each other's. Such matches have fits of their own, to the noise, of a rig that is far from
the start, or contradict something that is right, or have no fit: so this asks which exchange fits to the noise near the start.
@param knownSigma as of findingsOf @return a sentence; empty: no exchange explains it */
std::string exchangedCameras(const BundleStart& start, const Matches& matches, const GivenLengths& lengths, bool robust, double knownSigma);

/** Whether wrong matches, which were all to be taken as right, are why nothing fits: whether the rest fits far better without them.
@param adjustRobustly, measured without the wrong ones; measured may be null, as of findingsOf
@param sigma of the fit with them
@param nameOf a point @return a sentence; empty: it does not */
std::string wrongMatches(const BundleStart& start, const GivenLengths& lengths, const Readjust& adjustRobustly,
                         const MeasuredBundle* measured, double sigma, double knownSigma,
                         const std::function<std::string(int point)>& nameOf);

} // namespace tools

#endif // REFRACT_TOOLS_MISTAKEN_MATCHES_HPP
