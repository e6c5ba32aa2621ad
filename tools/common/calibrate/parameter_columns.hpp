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

/** A window's values into the columns that it has in these numbers, and a window with those values. It keeps what it has no columns
of. */
void putWindow(const cv::refract::GlassWindow& window, const ParameterColumns& at, double* numbers);
cv::refract::GlassWindow windowOf(cv::refract::GlassWindow window, const ParameterColumns& at, const double* numbers);

//! Where R (a rotation vector) and T of a camera after the first begin: after the parameters of all cameras.
int extrinsicsColumn(const RigModel& rig, int camera);
//! Of all of them.
int columnCount(const RigModel& rig);

//! These rows and columns of a matrix.
cv::Mat partOf(const cv::Mat& matrix, const std::vector<int>& rows, const std::vector<int>& columns);

//! Principal standard deviations of three columns, larger first.
std::vector<double> principalStd(const cv::Mat& covariance, int column);
//! Two of the normal of a camera's window, degrees; empty: it has none.
std::vector<double> normalStdDeg(const cv::Mat& covariance, const RigModel& rig, int camera);
//! Three of the centre of its dome or tube; empty: it has none.
std::vector<double> centerStd(const cv::Mat& covariance, const RigModel& rig, int camera);

//! How well it is known where a window is: the larger of normalStdDeg or of centerStd.
double placeStd(const cv::Mat& covariance, const RigModel& rig, int camera);

} // namespace tools

#endif // REFRACT_TOOLS_PARAMETER_COLUMNS_HPP
