// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/new_pane.hpp"
#include "calibrate/parameter_columns.hpp"

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! Where each column of one rig is in another that has wedges: these are the last of a camera.
std::vector<int> columnsIn(const RigModel& from, const RigModel& to)
{
    std::vector<int> columns;
    for (int k = 0; k < (int)from.cameras.size(); k++)
    {
        const ParameterColumns old = columnsOf(from, k), now = columnsOf(to, k);
        for (int i = old.lens; i < old.end; i++)
            columns.push_back(now.lens + i - old.lens);
    }
    for (int i = 0; i < 6*((int)from.cameras.size() - 1); i++)
        columns.push_back(extrinsicsColumn(to, 1) + i);
    return columns;
}

//! Independent of all else, as it is another piece.
void replaceVariance(Mat& covariance, int column, double variance)
{
    covariance.row(column).setTo(0.);
    covariance.col(column).setTo(0.);
    covariance.at<double>(column, column) = variance;
}

} // namespace

CheckInput withNewPanes(const CheckInput& input, const PaneStd& std)
{
    CheckInput result = input;
    result.rig = input.rig.clone();
    for (const Ptr<RefractiveCamera>& camera : result.rig.cameras)
    {
        GlassWindow window = camera->window();
        window.wedge.assign(window.thickness.size(), Vec2d());
        camera->setWindow(window);
    }
    const int count = columnCount(result.rig);
    result.covariance = Mat::zeros(count, count, CV_64F);
    const std::vector<int> columns = columnsIn(input.rig, result.rig);
    for (int i = 0; i < input.covariance.rows; i++)
        for (int j = 0; j < input.covariance.cols; j++)
            result.covariance.at<double>(columns[i], columns[j]) = input.covariance.at<double>(i, j);
    for (int k = 0; k < (int)result.rig.cameras.size(); k++)
    {
        const ParameterColumns at = columnsOf(result.rig, k);
        for (int i = 0; i < at.layers; i++)
        {
            replaceVariance(result.covariance, at.thickness + i, 2.*std.thickness*std.thickness);
            replaceVariance(result.covariance, at.index + i, 2.*std.index*std.index);
        }
        for (int i = at.wedge; i < at.end; i++)
            replaceVariance(result.covariance, i, std.wedge*std.wedge);
    }
    return result;
}

} // namespace tools
