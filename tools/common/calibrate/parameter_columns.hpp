// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PARAMETER_COLUMNS_HPP
#define REFRACT_TOOLS_PARAMETER_COLUMNS_HPP

#include "calibrate/rig_model.hpp"

namespace tools {

//! Which column of Fit::covariance is what. What a window of this shape has not is at `end`.
struct ParameterColumns
{
    int lens, window;                   //!< where the lens and the window begin
    int normal, distance;               //!< flat, bent
    int center, axis, radius;           //!< dome, tube; the axis is a tube's
    int thickness, index, innerIndex, outerIndex;
    int wedge, curvature, end;          //!< wedge == curvature: there is none
    int lensCount, layers;

    bool has(int column) const { return column < end; }
};
ParameterColumns columnsOf(const cv::refract::RefractiveCamera& camera, int first = 0);
ParameterColumns columnsOf(const RigModel& rig, int camera);

//! Where R (a rotation vector) and T of a camera after the first begin: after the parameters of all cameras.
int extrinsicsColumn(const RigModel& rig, int camera);
//! Of all of them.
int columnCount(const RigModel& rig);

//! These rows and columns of a matrix.
cv::Mat partOf(const cv::Mat& matrix, const std::vector<int>& rows, const std::vector<int>& columns);
//! Two of the normal of a camera's window, degrees; empty: it has none.
std::vector<double> normalStdDeg(const cv::Mat& covariance, const RigModel& rig, int camera);

//! How well it is known where a window is: the larger of normalStdDeg or of centerStd.
double placeStd(const cv::Mat& covariance, const RigModel& rig, int camera);

/* What a fit has estimated, by name and with its standard deviation. */

struct Fit;

//! A number that was estimated.
struct EstimatedParameter
{
    std::string name;
    int column;                 //!< of Fit::covariance
    double value, std;
    bool isNormal;              //!< or a tube's axis
};
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

#endif // REFRACT_TOOLS_PARAMETER_COLUMNS_HPP
