// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MOVED_RIG_HPP
#define REFRACT_TOOLS_MOVED_RIG_HPP

#include "assess/check_input.hpp"

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

} // namespace tools

#endif // REFRACT_TOOLS_MOVED_RIG_HPP
