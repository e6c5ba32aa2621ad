// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/check_input.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"
#include "measure/measurement.hpp"

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double EXACT = 1e8;       // degrees of freedom of a noise level that is given

//! Where each column of one rig is in another that has wedges: after these a camera has only its curvature.
std::vector<int> columnsIn(const RigModel& from, const RigModel& to)
{
    std::vector<int> columns;
    for (int k = 0; k < (int)from.cameras.size(); k++)
    {
        const ParameterColumns old = columnsOf(from, k), now = columnsOf(to, k);
        for (int i = old.lens; i < old.end; i++)
            columns.push_back(i < old.curvature ? now.lens + i - old.lens : now.curvature);
    }
    for (int i = 0; i < 6*((int)from.cameras.size() - 1); i++)
        columns.push_back(extrinsicsColumn(to, 1) + i);
    for (int i = 0; i < TARGET_ERRORS && !from.targetCovariance.empty(); i++)
        columns.push_back(columnCount(to) + i);
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

CheckInput checkInputOf(const Calibration& calibration, const std::string& filename, double pixelSigma)
{
    CheckInput input;
    input.rig = modelOf(calibration);
    input.rig.windows = calibration.windows;
    input.covariance = calibration.covariance;
    input.sources = calibration.provenance.sources;
    input.square = calibration.square;
    input.sigma = pixelSigma > 0 ? pixelSigma : pixelSigmaOf(calibration);
    input.dof = pixelSigma > 0 || !(calibration.dof > 0) ? EXACT : calibration.dof;
    if (!(input.sigma > 0))
        throw Failure("'" + filename + "' does not say how large the noise of a pixel is: calibrate with refract_calib, or "
                      "give --pixel-sigma");
    if (input.covariance.empty() && !(pixelSigma > 0))
        throw Failure("'" + filename + "' has no covariance: calibrate with refract_calib, or give --pixel-sigma to take "
                      "the file as exact");
    return input;
}

CheckInput withWedges(const CheckInput& input)
{
    CheckInput result = input;
    result.rig = input.rig.clone();
    for (const Ptr<RefractiveCamera>& camera : result.rig.cameras)
    {
        GlassWindow window = camera->window();
        if (isRound(window))
            continue;
        window.wedge.resize(window.thickness.size());
        camera->setWindow(window);
    }
    const int count = columnCount(result.rig) + (result.rig.targetCovariance.empty() ? 0 : TARGET_ERRORS);
    result.covariance = Mat(count, count, CV_64F, Scalar(0));       // not Mat::zeros: assigned, it would clear the numbers of the input
    const std::vector<int> columns = columnsIn(input.rig, result.rig);
    for (int i = 0; i < input.covariance.rows; i++)
        for (int j = 0; j < input.covariance.cols; j++)
            result.covariance.at<double>(columns[i], columns[j]) = input.covariance.at<double>(i, j);
    for (UncertaintySource& source : result.sources)
    {
        const Mat old = source.factor;
        source.factor = Mat(columnCount(result.rig), old.cols, CV_64F, Scalar(0));
        for (int i = 0; i < old.rows; i++)
            old.row(i).copyTo(source.factor.row(columns[i]));
    }
    return result;
}

CheckInput withTargetColumns(const CheckInput& input, const Mat& covariance)
{
    CheckInput result = input;
    result.rig.targetCovariance = covariance.empty() ? Mat(TARGET_ERRORS, TARGET_ERRORS, CV_64F, Scalar(0)) : covariance;
    const int count = columnCount(input.rig);
    result.covariance = Mat(count + TARGET_ERRORS, count + TARGET_ERRORS, CV_64F, Scalar(0));
    if (!input.covariance.empty())
        input.covariance.copyTo(result.covariance(Rect(0, 0, count, count)));
    result.rig.targetCovariance.copyTo(result.covariance(Rect(count, count, TARGET_ERRORS, TARGET_ERRORS)));
    return result;
}

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
