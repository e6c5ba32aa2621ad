// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/new_pane.hpp"
#include "calibrate/parameter_columns.hpp"

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

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
    CheckInput result = withWedges(input);
    for (const Ptr<RefractiveCamera>& camera : result.rig.cameras)
    {
        GlassWindow window = camera->window();
        window.wedge.assign(window.wedge.size(), Vec2d());
        camera->setWindow(window);
    }
    for (int k = 0; k < (int)result.rig.cameras.size(); k++)
    {
        const ParameterColumns at = columnsOf(result.rig, k);
        for (int i = 0; i < at.layers; i++)
        {
            replaceVariance(result.covariance, at.thickness + i, 2.*std.thickness*std.thickness);
            replaceVariance(result.covariance, at.index + i, 2.*std.index*std.index);
        }
        for (int i = at.wedge; i < at.curvature; i++)
            replaceVariance(result.covariance, i, std.wedge*std.wedge);
    }
    return result;
}

} // namespace tools
