// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/parameter_columns.hpp"
#include "calibrate/fit.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include "window/parameters.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

ParameterColumns columnsOf(const RefractiveCamera& camera, int first)
{
    const WindowLayout window = windowLayout(camera.window());
    const bool round = isRound(camera.window());
    ParameterColumns at;
    at.lens = first;
    at.lensCount = camera.lensParameters().rows;
    at.layers = window.layers;
    at.window = first + at.lensCount;
    at.end = at.window + window.count;
    at.normal = round ? at.end : at.window + window.normal;
    at.center = round ? at.window + window.normal : at.end;
    at.axis = window.axis < window.media ? at.window + window.axis : at.end;
    at.distance = round ? at.end : at.window + window.distance;
    at.radius = round ? at.window + window.distance : at.end;
    at.thickness = at.window + window.thickness;
    at.index = at.window + window.index;
    at.innerIndex = at.window + window.innerIndex;
    at.outerIndex = at.window + window.outerIndex;
    at.wedge = at.window + window.wedge;
    at.curvature = at.window + window.curvature;
    return at;
}

ParameterColumns columnsOf(const RigModel& rig, int camera)
{
    int first = 0;
    for (int c = 0; c < camera; c++)
        first = columnsOf(*rig.cameras[c], first).end;
    return columnsOf(*rig.cameras[camera], first);
}

int extrinsicsColumn(const RigModel& rig, int camera)
{
    return columnsOf(rig, (int)rig.cameras.size() - 1).end + 6*(camera - 1);
}

int columnCount(const RigModel& rig) { return extrinsicsColumn(rig, (int)rig.cameras.size()); }

Mat partOf(const Mat& matrix, const std::vector<int>& rows, const std::vector<int>& columns)
{
    Mat result((int)rows.size(), (int)columns.size(), CV_64F);
    for (int i = 0; i < result.rows; i++)
        for (int j = 0; j < result.cols; j++)
            result.at<double>(i, j) = matrix.at<double>(rows[i], columns[j]);
    return result;
}

//! Principal standard deviations of three columns, larger first.
static std::vector<double> principalStd(const Mat& covariance, int column)
{
    Mat eigenvalues;
    eigen(covariance(Rect(column, column, 3, 3)), eigenvalues);
    std::vector<double> result;
    for (int i = 0; i < 3; i++)
        result.push_back(std::sqrt(std::max(0., eigenvalues.at<double>(i))));
    return result;
}

std::vector<double> normalStdDeg(const Mat& covariance, const RigModel& rig, int camera)
{
    const ParameterColumns at = columnsOf(rig, camera);
    if (!at.has(at.normal))
        return {};
    std::vector<double> std = principalStd(covariance, at.normal);
    std.pop_back();             // rank 2: along the normal itself it is zero
    for (double& s : std)
        s *= 180./CV_PI;
    return std;
}

//! Three of the centre of its dome or tube; empty: it has none.
static std::vector<double> centerStd(const Mat& covariance, const RigModel& rig, int camera)
{
    const ParameterColumns at = columnsOf(rig, camera);
    return at.has(at.center) ? principalStd(covariance, at.center) : std::vector<double>();
}

double placeStd(const Mat& covariance, const RigModel& rig, int camera)
{
    const std::vector<double> normal = normalStdDeg(covariance, rig, camera);
    return normal.empty() ? centerStd(covariance, rig, camera)[0] : normal[0];
}

static void append(std::vector<EstimatedParameter>& list, const Fit& fit, const std::string& name, int column, double value,
                   bool isNormal = false)
{
    const double std = fit.stdDeviations.at<double>(column);
    if (std > 0)
        list.push_back({name, column, value, std, isNormal});
}

WindowStd windowStd(const Fit& fit, int camera)
{
    const ParameterColumns at = columnsOf(fit.rig, camera);
    const auto std = [&](int column) { return at.has(column) ? fit.stdDeviations.at<double>(column) : 0.; };
    WindowStd result;
    result.normalDeg = normalStdDeg(fit.covariance, fit.rig, camera);
    result.distance = std(at.distance);
    for (int i = at.center; at.has(at.center) && i < at.center + 3; i++)
        result.center.push_back(std(i));
    if (at.has(at.axis))
    {
        const std::vector<double> axis = principalStd(fit.covariance, at.axis);
        result.axisDeg = {axis[0]*180./CV_PI, axis[1]*180./CV_PI};
    }
    result.radius = std(at.radius);
    for (int i = 0; i < at.layers; i++)
    {
        result.thickness.push_back(std(at.thickness + i));
        result.index.push_back(std(at.index + i));
    }
    result.outerIndex = std(at.outerIndex);
    for (int i = at.wedge; i < at.curvature; i++)
        result.wedge.push_back(std(i));
    result.curvature = std(at.curvature);
    return result;
}

/** Of a unit vector two numbers are told, those that its direction changes most: this one follows. So it does of a point of a tube's axis,
which may be anywhere along it. */
static int followingOf(const Vec3d& unit)
{
    return std::abs(unit[2]) >= std::max(std::abs(unit[0]), std::abs(unit[1])) ? 2 : std::abs(unit[1]) >= std::abs(unit[0]);
}

bool followsOthers(const GlassWindow& window, const ParameterColumns& at, int column)
{
    if (at.has(at.normal))
        return column == at.normal + followingOf(window.normal);
    const int follows = followingOf(window.axis);
    return at.has(at.axis) && (column == at.center + follows || column == at.axis + follows);
}

//! Where the window is: the first surface.
static void appendPlace(std::vector<EstimatedParameter>& list, const Fit& fit, const std::string& prefix, const ParameterColumns& at,
                        const GlassWindow& window)
{
    if (at.has(at.normal))
    {
        append(list, fit, prefix + "normal x", at.normal, window.normal[0], true);
        append(list, fit, prefix + "normal y", at.normal + 1, window.normal[1], true);
        append(list, fit, prefix + "distance", at.distance, window.distance);
        return;
    }
    const int follows = at.has(at.axis) ? followingOf(window.axis) : -1;
    for (int i = 0; i < 3; i++)
        if (i != follows)
            append(list, fit, prefix + "centre " + "xyz"[i], at.center + i, window.center[i]);
    for (int i = 0; i < 3 && at.has(at.axis); i++)
        if (i != follows)
            append(list, fit, prefix + "axis " + "xyz"[i], at.axis + i, window.axis[i], true);
    append(list, fit, prefix + "radius", at.radius, window.radius);
}

std::vector<EstimatedParameter> estimatedWindowParameters(const Fit& fit)
{
    std::vector<EstimatedParameter> list;
    for (int c = 0; c < (int)fit.rig.cameras.size(); c++)
    {
        if (!fit.rig.ownsWindow(c))
            continue;
        const std::string prefix = fit.rig.cameras.size() == 1 ? "" : format("camera %d ", c + 1);
        const GlassWindow window = fit.rig.cameras[c]->window();
        const ParameterColumns at = columnsOf(fit.rig, c);
        appendPlace(list, fit, prefix, at, window);
        for (int i = 0; i < at.layers; i++)
        {
            const std::string layer = at.layers == 1 ? "" : format(" %d", i + 1);
            append(list, fit, prefix + "thickness" + layer, at.thickness + i, window.thickness[i]);
            append(list, fit, prefix + "index" + layer, at.index + i, window.index[i]);
        }
        append(list, fit, prefix + "outer index", at.outerIndex, window.outerIndex);
        for (int i = at.wedge; i < at.curvature; i++)
        {
            const int layer = (i - at.wedge)/2, axis = (i - at.wedge) % 2;
            append(list, fit, prefix + "wedge " + "xy"[axis] + (at.layers == 1 ? "" : format(" %d", layer + 1)), i,
                   window.wedge[layer][axis]);
        }
        if (at.has(at.curvature))
            append(list, fit, prefix + "curvature", at.curvature, window.curvature);
    }
    return list;
}

std::vector<EstimatedParameter> estimatedRigParameters(const Fit& fit)
{
    std::vector<EstimatedParameter> list;
    int end = 0;
    for (int c = 0; c < (int)fit.rig.cameras.size(); c++)
    {
        const std::string prefix = fit.rig.cameras.size() == 1 ? "" : format("camera %d ", c + 1);
        const Mat lens = fit.rig.cameras[c]->lensParameters();
        const std::vector<String> names = fit.rig.cameras[c]->parameterNames();
        const ParameterColumns at = columnsOf(fit.rig, c);
        for (int i = 0; i < at.lensCount; i++)
            append(list, fit, prefix + names[i], at.lens + i, lens.at<double>(i));
        end = at.end;
    }
    for (int c = 1; c < (int)fit.rig.cameras.size(); c++, end += 6)
    {
        const std::string number = c == 1 ? "" : std::to_string(c + 1);        // as in calib.yml
        const Vec3d rvec = rotationVector(fit.rig.extrinsics[c].R);
        for (int i = 0; i < 3; i++)
            append(list, fit, "R" + number + " rotation vector " + "xyz"[i], end + i, rvec[i]);
        for (int i = 0; i < 3; i++)
            append(list, fit, "T" + number + " " + "xyz"[i], end + 3 + i, fit.rig.extrinsics[c].t[i]);
    }
    return list;
}

bool isSplined(const RefractiveCamera& lens) { return lens.lensModel().find("LENSMODEL_SPLINED") == 0; }

} // namespace tools
