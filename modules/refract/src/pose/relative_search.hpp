// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RELATIVE_SEARCH_HPP
#define OPENCV_REFRACT_RELATIVE_SEARCH_HPP

#include "pose/consensus.hpp"
#include "pose/relative_pose.hpp"

/* Where the relative pose may be, from matches of which some are wrong. */

namespace cv { namespace refract {

//! How well the matches agree with a pose. @param limit of an inlier's error
Consensus consensusOf(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& motion, double limit);

//! At the greatest length that is tried: refraction tells no length any more.
bool isInfinitelyFar(const MatchedCameras& pair, const RigidTransform& motion);

//! The most likely pose near this one: over all lengths, if windows tell them and they are finite.
double refineLength(const MatchedCameras& pair, const PixelMatches& matches, RigidTransform& motion, int iterations);

//! Some of many matches, the same ones every time.
PixelMatches sampleOf(const PixelMatches& matches);

//! Where the search from pinholes' poses ends, each place once.
std::vector<Consensus> placesOf(const MatchedCameras& pair, const PixelMatches& matches, double limit,
                                const std::vector<RigidTransform>& starts);

}} // namespace

#endif // OPENCV_REFRACT_RELATIVE_SEARCH_HPP
