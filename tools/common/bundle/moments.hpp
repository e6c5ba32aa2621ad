// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MOMENTS_HPP
#define REFRACT_TOOLS_MOMENTS_HPP

#include "bundle/bundle_adjustment.hpp"

/* Whether the images of all cameras in one row are of one moment. */
namespace tools {

/** How far pixels are from the points that their rays give with the start; px, of the middling point that this camera saw. Infinite: too
few. */
double missOf(const BundleStart& start, const RigPixels& pixels, int camera);

/** Throws Failure if the images of one camera are of later or earlier moments than those of the others: if rays meet far better after
some rows of the table. An adjustment to such matches creeps. Tables without images have no moments. */
void requireSameMoments(const BundleStart& start, const Matches& matches);

const double EXPLAINS = 0.5;        // of the noise of a fit: what leaves less of it is why it does not fit

//! Whether a fit leaves more noise than matches of one moment do. @param knownSigma as of findingsOf
bool isNoisy(double sigma, double knownSigma);

/** The same after a fit to the matches, which bends a rig until it hides a good part of it: whether they fit far better after some rows.
@param sigma of the fit @return a sentence; empty: no camera is late */
std::string lateCamera(const BundleStart& start, const Matches& matches, const GivenLengths& lengths, bool robust, double sigma);

} // namespace tools

#endif // REFRACT_TOOLS_MOMENTS_HPP
