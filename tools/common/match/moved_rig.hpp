// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MOVED_RIG_HPP
#define REFRACT_TOOLS_MOVED_RIG_HPP

#include "assess/check_input.hpp"
#include "match/match_noise.hpp"

/* What may have become of a rig since its calibration, and how far from their curves matches then are. */
namespace tools {

//! Standard deviations of what may have turned since, about its own centre, degrees.
struct MayHaveTurned
{
    std::vector<double> cameras;        //!< one for all, or one of each; empty: none has
    double windows = 0.;

    double ofCamera(int c) const { return cameras.empty() ? 0. : cameras[cameras.size() == 1 ? 0 : c]; }
};

/** The calibration's covariance, with every turn that the table of changes knows: of a camera about its own centre, of a window. */
cv::Mat covarianceOfMoved(const CheckInput& input, const MayHaveTurned& turned);

//! The same with every change of that table. @param depth of the scene in camera 1 @param share of each change's range (change.hpp)
cv::Mat covarianceOfChanged(const CheckInput& input, double depth, double share);

/** How far a match of two cameras may be from its epipolar curve, px: three standard deviations of what the calibration does not know,
and the largest turn by so many degrees. @param depth z of the scene in the frame of camera 1 */
double searchWidth(const CheckInput& input, int first, int second, const cv::Vec2d& depth, double degrees);

/* What errs together. A thing that moved between the images of a moment, or a reflection, may miss its curves by so little that no match of
it is a wrong one by itself. But all of it misses to the same side, where noise does not: of n matches the sum of the misses e, in standard
deviations, has

    |e_1 + ... + e_n|^2 / n ~ chi^2

of as many degrees of freedom as one match has. So n matches show together what is sqrt(n) times less than what one shows. */

/** Of each match, the group in which some may err together: those of one moment; and those that are at the same place at several moments,
as a reflection is, and dirt on a window. */
std::vector<int> groupsOf(const ScaledMatches& all);

/** Where most matches of a part of an image miss, at all moments together, those that do not are near their curves by chance. Nothing else
tells the rig there, so that it would follow them. @param candidates each is near its curve */
std::vector<uchar> inContradictedParts(const ScaledMatches& scaled, const RigModel& rig, const std::vector<int>& candidates);

/** These, and which matches are of a part of their group, neighbours in an image, that errs together.
@param residuals of the same matches */
std::vector<uchar> inMovedParts(const ScaledMatches& scaled, const std::vector<int>& groups, const RigModel& rig,
                                const std::vector<MatchResidual>& residuals, const MatchNoise& noise, const std::vector<int>& candidates);

} // namespace tools

#endif // REFRACT_TOOLS_MOVED_RIG_HPP
