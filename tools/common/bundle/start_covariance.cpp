// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "bundle/start_covariance.hpp"
#include "calibrate/given_window.hpp"
#include "calibrate/parameter_columns.hpp"

#include <algorithm>
#include <map>

using namespace cv::refract;

namespace tools {

namespace {

struct Columns
{
    int first, count;
};

//! The columns of a camera that a name stands for; a window of another shape may have none.
std::vector<int> columnsOfName(const ParameterColumns& at, const std::string& name)
{
    const std::multimap<std::string, Columns> all = {
        {"normal", {at.normal, 3}}, {"center", {at.center, 3}}, {"center", {at.axis, 3}}, {"intrinsics", {at.lens, at.lensCount}},
        {"thickness", {at.thickness, at.layers}}, {"index", {at.index, at.layers}}, {"distance", {at.distance, 1}},
        {"radius", {at.radius, 1}}, {"outer-index", {at.outerIndex, 1}}, {"wedge", {at.wedge, at.curvature - at.wedge}},
        {"curvature", {at.curvature, 1}}};
    std::vector<int> columns;
    const auto range = all.equal_range(name);
    for (auto it = range.first; it != range.second; ++it)
        for (int i = 0; i < it->second.count && at.has(it->second.first); i++)
            columns.push_back(it->second.first + i);
    return columns;
}

//! Where each parameter of one camera is in another that has them all.
std::vector<int> sameColumns(const RefractiveCamera& from, const RefractiveCamera& to, int first)
{
    std::vector<int> columns;
    const std::vector<cv::String> all = to.parameterNames();
    for (const cv::String& name : from.parameterNames())
        columns.push_back(first + int(std::find(all.begin(), all.end(), name) - all.begin()));
    return columns;
}

} // namespace

void addFree(int flags, RigModel& rig, cv::Mat& covariance)
{
    RigModel larger = rig.clone();
    for (const cv::Ptr<RefractiveCamera>& camera : larger.cameras)
        camera->setWindow(withEstimated(camera->window(), GivenStd(), flags));
    std::vector<int> columns;
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const std::vector<int> own = sameColumns(*rig.cameras[c], *larger.cameras[c], columnsOf(larger, c).lens);
        columns.insert(columns.end(), own.begin(), own.end());
    }
    const int count = columnCount(larger);
    for (int i = extrinsicsColumn(larger, 1); i < count; i++)
        columns.push_back(i);
    cv::Mat more = cv::Mat::zeros(count, count, CV_64F);
    for (int i = 0; i < covariance.rows; i++)
        for (int j = 0; j < covariance.cols; j++)
            more.at<double>(columns[i], columns[j]) = covariance.at<double>(i, j);
    rig = larger;
    covariance = more;
}

void forget(const std::vector<std::string>& free, const RigModel& rig, cv::Mat& covariance)
{
    std::vector<int> columns;
    for (const std::string& name : free)
    {
        for (int c = 0; c < (int)rig.cameras.size(); c++)
        {
            const std::vector<int> own = columnsOfName(columnsOf(rig, c), name);
            columns.insert(columns.end(), own.begin(), own.end());
        }
        for (int i = extrinsicsColumn(rig, 1); name == "extrinsics" && i < covariance.rows; i++)
            columns.push_back(i);
    }
    for (int i : columns)
    {
        covariance.row(i) = 0.;
        covariance.col(i) = 0.;
    }
}

cv::Mat covarianceOfGiven(const std::function<GivenStd(const GlassWindow&)>& of, int flags, RigModel& rig)
{
    std::vector<GivenStd> stds;
    for (const cv::Ptr<RefractiveCamera>& camera : rig.cameras)
    {
        const GlassWindow window = camera->window();
        stds.push_back(of(window));
        camera->setWindow(withEstimated(window, stds.back(), flags));
    }
    cv::Mat covariance = cv::Mat::zeros(columnCount(rig), columnCount(rig), CV_64F);
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        if (rig.ownsWindow(c))
            putVariances(stds[c], columnsOf(rig, c), covariance);
    return covariance;
}

} // namespace tools
