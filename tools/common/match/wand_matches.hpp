// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_WAND_MATCHES_HPP
#define REFRACT_TOOLS_WAND_MATCHES_HPP

#include "bundle/bundle_start.hpp"
#include "console/frames.hpp"
#include "console/json.hpp"
#include "match/wand_finder.hpp"

/* A wand with a ball at each end that is waved before cameras which do not move: from images to what a bundle adjustment takes. */
namespace tools {

//! --wand=LENGTH[,STD]; without STD a thousandth of the length.
Wand parseWand(const std::string& text);

//! The balls that cameras see; all are brighter than their background, or all darker, as more moments show two.
struct BallSightings
{
    std::vector<std::string> moments;
    std::vector<std::vector<Balls>> balls;      //!< of each moment, per camera
    int crowded = 0;                            //!< images with more round things than are looked at
};

//! Of all moments that two cameras have images of. Throws Failure where there are few, or few show two balls.
BallSightings findBalls(const Calibration& calibration, std::vector<Frames>& cameras, bool quiet);

struct WandMatches
{
    Matches matches;                //!< a and b, of which a is the larger ball, or either
    GivenLengths lengths;
    int moments = 0, unseen = 0;    //!< all; where no two cameras see two balls
    int unfit = 0, unclear = 0;     //!< where no two balls are a wand, as far as rays and length tell; where several are
    int crowded = 0;                //!< images, of any moment, with more round things than are looked at
};

/** Which of the balls are the ends of the wand: those whose rays meet, and that are as far from each other as it is long. A start of
nominal values lets rays miss each other by many pixels; so what is clear tells the rig first, and this what the others are. Throws
Failure where hardly any moment shows a wand, with what is known of why, or where those that do let nothing be fitted, with their line.
@param path of the start, for the text */
WandMatches matchWand(const BundleStart& start, const std::string& path, const BallSightings& seen, const Wand& wand);

//! "wand: 78 of 80 moments; left out: 1 where no two fit, 1 where several do".
std::string textOf(const WandMatches& found);

//! Its numbers.
Json jsonOf(const WandMatches& found);

} // namespace tools

#endif // REFRACT_TOOLS_WAND_MATCHES_HPP
