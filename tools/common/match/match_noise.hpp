// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MATCH_NOISE_HPP
#define REFRACT_TOOLS_MATCH_NOISE_HPP

#include "bundle/matches.hpp"
#include "calibrate/rig_model.hpp"

/* How well features are placed. A large blob is placed less well than a small one, and one that looks different in two images, as a surface
seen from two sides does, less well than one that looks the same:

    variance of a coordinate = floor^2 + (share^2 + unlikeShare^2 unlike) scale^2

The three numbers come from the residuals of the matches themselves, by maximum likelihood: they differ with texture, blur and light. */
namespace tools {

/* Matches, and which of them to take. */

struct ScaledMatches
{
    Matches matches;
    std::vector<std::vector<double>> scales;        //!< of the features, per camera, per point
    //! Per point: distance of its features' descriptors over the usual one; empty: all are alike.
    std::vector<double> unlike = {};

    int size() const { return (int)matches.names.size(); }
    void add(const ScaledMatches& others);
    ScaledMatches only(const std::vector<int>& points) const;
};

//! Which matches are at the same place at another moment, too: these stand still, or are reflections.
std::vector<uchar> recurring(const ScaledMatches& all);

/** So many at most, spread over the image and over depth, as a corner of an image knows more than its middle; in each cell the smallest
features first, as they are placed best. What was taken already, be it at another moment, is not taken again: a detail of a scene that
stands still tells no more the second time.
@param rig that measures the depths */
std::vector<int> spreadChoice(const ScaledMatches& all, const RigModel& rig, int count);

struct MatchResidual;

struct MatchNoise
{
    double floor = 0., share = 0., unlikeShare = 0.;

    //! @param unlike ScaledMatches::unlike
    double stdOf(double scale, double unlike) const;
    double varianceOf(const MatchResidual& residual) const;     //!< of each of its numbers
};

//! What the residuals of one match tell: of n cameras 2 n - 3 numbers, as the rest of its pixels is the point's.
struct MatchResidual
{
    double squares, scale2;         //!< px^2; mean of the squared scales
    double unlike;                  //!< ScaledMatches::unlike
    int count;                      //!< of the numbers; 0: there is no such point

    bool isWithin(const MatchNoise& noise) const;
};

std::vector<MatchResidual> residualsOf(const ScaledMatches& scaled, const RigModel& rig);

/** From the residuals of right matches and of others, which are anywhere: of each the probability that it is right, and of those that are
the noise, in turn. */
MatchNoise noiseOf(const std::vector<MatchResidual>& residuals);

/** What looks so unlike in its images that many such matches miss their curves. These show how many of the others miss along them, where no
residual shows it: beyond this, all are left out. */
double unlikeLimitOf(const std::vector<MatchResidual>& residuals, const MatchNoise& noise);

} // namespace tools

#endif // REFRACT_TOOLS_MATCH_NOISE_HPP
