// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ESTIMATED_PARAMETERS_HPP
#define REFRACT_TOOLS_ESTIMATED_PARAMETERS_HPP

#include "calibrate/fit.hpp"
#include "calibrate/parameter_columns.hpp"

/* What a fit has estimated, by name and with its standard deviation. */
namespace tools {

//! A number that was estimated.
struct EstimatedParameter
{
    std::string name;
    int column;                 //!< of Fit::covariance
    double value, std;
    bool isNormal;              //!< or a tube's axis
};

/** Of a unit vector two numbers are told, those that its direction changes most: this one follows. So it does of a point of a tube's axis,
which may be anywhere along it. */
int followingOf(const cv::Vec3d& unit);
//! Whether a column is of such a number.
bool followsOthers(const cv::refract::GlassWindow& window, const ParameterColumns& at, int column);

//! Window parameters that were free, camera after camera; of directions and of a tube's centre two, of a shared window once.
std::vector<EstimatedParameter> estimatedWindowParameters(const Fit& fit);

//! Lens parameters and R (rotation vector), T of each camera but the first that were free.
std::vector<EstimatedParameter> estimatedRigParameters(const Fit& fit);

//! One standard deviation of what was free in the window of a camera.
WindowStd windowStd(const Fit& fit, int camera);

//! Of splined lenses nothing is estimated, --free=intrinsics or not.
bool isSplined(const cv::refract::RefractiveCamera& lens);

} // namespace tools

#endif // REFRACT_TOOLS_ESTIMATED_PARAMETERS_HPP
