// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/parameter_columns.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

ParameterColumns columnsOf(const RefractiveCamera& camera, int first)
{
    ParameterColumns columns;
    columns.names = camera.parameterNames();
    columns.lensCount = camera.lensParameters().rows;
    columns.layers = (int)camera.window().thickness.size();
    const auto find = [&](const char* name)
    { return first + int(std::find(columns.names.begin(), columns.names.end(), name) - columns.names.begin()); };
    columns.lens = first;
    columns.normal = find("normal[0]");
    columns.distance = find("distance");
    columns.thickness = find("thickness[0]");
    columns.index = find("index[0]");
    columns.innerIndex = find("innerIndex");
    columns.outerIndex = find("outerIndex");
    columns.wedge = find("wedge[0][0]");
    columns.end = first + (int)columns.names.size();
    return columns;
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
    std::copy_n(window.normal.val, 3, numbers + at.normal);
    numbers[at.distance] = window.distance;
    for (int i = 0; i < at.layers; i++)
    {
        numbers[at.thickness + i] = window.thickness[i];
        numbers[at.index + i] = window.index[i];
    }
    numbers[at.innerIndex] = window.innerIndex;
    numbers[at.outerIndex] = window.outerIndex;
    for (int i = at.wedge; i < at.end; i++)
        numbers[i] = window.wedge[(i - at.wedge)/2][(i - at.wedge) % 2];
}

GlassWindow windowOf(GlassWindow window, const ParameterColumns& at, const double* numbers)
{
    window.normal = normalize(Vec3d(numbers + at.normal));
    window.distance = numbers[at.distance];
    for (int i = 0; i < at.layers; i++)
    {
        window.thickness[i] = numbers[at.thickness + i];
        window.index[i] = numbers[at.index + i];
        if (at.wedge < at.end)
            window.wedge[i] = Vec2d(numbers + at.wedge + 2*i);
    }
    window.innerIndex = numbers[at.innerIndex];
    window.outerIndex = numbers[at.outerIndex];
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

std::vector<double> normalStdDeg(const Mat& covariance, const RigModel& rig, int camera)
{
    const int at = columnsOf(rig, camera).normal;
    // Rank 2: the third eigenvalue, along the normal itself, is zero.
    Mat eigenvalues;
    eigen(covariance(Rect(at, at, 3, 3)), eigenvalues);
    std::vector<double> result;
    for (int i = 0; i < 2; i++)
        result.push_back(std::sqrt(std::max(0., eigenvalues.at<double>(i)))*180./CV_PI);
    return result;
}

} // namespace tools
