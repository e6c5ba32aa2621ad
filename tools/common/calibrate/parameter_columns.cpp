// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
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

std::vector<double> principalStd(const Mat& covariance, int column)
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

std::vector<double> centerStd(const Mat& covariance, const RigModel& rig, int camera)
{
    const ParameterColumns at = columnsOf(rig, camera);
    return at.has(at.center) ? principalStd(covariance, at.center) : std::vector<double>();
}

double placeStd(const Mat& covariance, const RigModel& rig, int camera)
{
    const std::vector<double> normal = normalStdDeg(covariance, rig, camera);
    return normal.empty() ? centerStd(covariance, rig, camera)[0] : normal[0];
}

} // namespace tools
