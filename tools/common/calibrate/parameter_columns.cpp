// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/parameter_columns.hpp"
#include "calibrate/fit.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

//! In the order of parameterNames(), which are strings: those would take longer than what is done with the columns.
ParameterColumns columnsOf(const RefractiveCamera& camera, int first)
{
    const GlassWindow window = camera.window();
    const bool round = isRound(window);
    int next = first;
    const auto take = [&next](int count) { return (next += count) - count; };
    const int NONE = -1;
    ParameterColumns at;
    at.lensCount = camera.lensParameters().rows;
    at.layers = (int)window.thickness.size();
    at.lens = take(at.lensCount);
    at.window = next;
    at.normal = round ? NONE : take(3);
    at.center = round ? take(3) : NONE;
    at.axis = window.shape == WINDOW_TUBE ? take(3) : NONE;
    at.distance = round ? NONE : take(1);
    at.radius = round ? take(1) : NONE;
    at.thickness = take(at.layers);
    at.index = take(at.layers);
    at.innerIndex = take(1);
    at.outerIndex = take(1);
    at.wedge = take(window.wedge.empty() ? 0 : 2*at.layers);
    at.curvature = take(window.shape == WINDOW_BENT);
    at.end = next;
    for (int* column : {&at.normal, &at.center, &at.axis, &at.distance, &at.radius})
        if (*column == NONE)
            *column = at.end;
    return at;
}

ParameterColumns columnsOf(const RigModel& rig, int camera)
{
    int first = 0;
    for (int c = 0; c < camera; c++)
        first = columnsOf(*rig.cameras[c], first).end;
    return columnsOf(*rig.cameras[camera], first);
}

void putWindow(const GlassWindow& window, const ParameterColumns& at, double* numbers)
{
    const auto put = [&](const Vec3d& vector, int column) {
        if (at.has(column))
            std::copy_n(vector.val, 3, numbers + column);
    };
    const auto putOne = [&](double number, int column) {
        if (at.has(column))
            numbers[column] = number;
    };
    put(window.normal, at.normal);
    putOne(window.distance, at.distance);
    put(window.center, at.center);
    put(window.axis, at.axis);
    putOne(window.radius, at.radius);
    for (int i = 0; i < at.layers; i++)
    {
        numbers[at.thickness + i] = window.thickness[i];
        numbers[at.index + i] = window.index[i];
    }
    numbers[at.innerIndex] = window.innerIndex;
    numbers[at.outerIndex] = window.outerIndex;
    for (int i = at.wedge; i < at.curvature; i++)
        numbers[i] = window.wedge[(i - at.wedge)/2][(i - at.wedge) % 2];
    putOne(window.curvature, at.curvature);
}

GlassWindow windowOf(GlassWindow window, const ParameterColumns& at, const double* numbers)
{
    const auto takeOne = [&](double& number, int column) {
        if (at.has(column))
            number = numbers[column];
    };
    if (at.has(at.normal))
        window.normal = normalize(Vec3d(numbers + at.normal));
    if (at.has(at.center))
        window.center = Vec3d(numbers + at.center);
    if (at.has(at.axis))
        window.axis = normalize(Vec3d(numbers + at.axis));
    takeOne(window.distance, at.distance);
    takeOne(window.radius, at.radius);
    for (int i = 0; i < at.layers; i++)
    {
        window.thickness[i] = numbers[at.thickness + i];
        window.index[i] = numbers[at.index + i];
        if (at.wedge < at.curvature)
            window.wedge[i] = Vec2d(numbers + at.wedge + 2*i);
    }
    window.innerIndex = numbers[at.innerIndex];
    window.outerIndex = numbers[at.outerIndex];
    takeOne(window.curvature, at.curvature);
    return window;
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
            append(list, fit, "T" + number + " " + "xyz"[i], end + 3 + i, fit.rig.extrinsics[c].T[i]);
    }
    return list;
}

bool isSplined(const RefractiveCamera& lens) { return lens.lensModel().find("LENSMODEL_SPLINED") == 0; }

} // namespace tools
