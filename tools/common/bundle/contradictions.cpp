// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Whether matches contradict what was known of a number. Those that may be are told by the derivatives: what was known and what is
// found differ by x - x0, which has the covariance C0 - C. Where the squares are not a parabola, as of a distance that is hardly
// known, that is no measure: so each is set free, and the squares must be smaller by as much.
#include "bundle/bundle_findings.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/failure.hpp"
#include "measure/rig_vector.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double MANY = 5.;                 // standard deviations

//! What a column is of, and the columns that are known together with it: those of a direction, a centre, R or T.
struct KnownValue
{
    std::string name;
    int first, count;
    double deviations = 0.;             //!< by the derivatives
};

KnownValue valueAt(const RigModel& rig, int column)
{
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        if (column >= at.end)
            continue;
        const std::string of = format("camera %d's ", c + 1);
        for (const auto& vector : {std::pair<int, const char*>(at.normal, "normal"), {at.center, "centre"}, {at.axis, "axis"}})
            if (at.has(vector.first) && column >= vector.first && column < vector.first + 3)
                return {of + vector.second, vector.first, 3};
        return {of + rig.cameras[c]->parameterNames()[column - at.lens], column, 1};
    }
    const int place = column - extrinsicsColumn(rig, 1), camera = place/6 + 1;
    return {std::string(place % 6 < 3 ? "R" : "T") + (camera == 1 ? "" : std::to_string(camera + 1)), column - place % 3, 3};
}

//! Those that differ by more than many standard deviations, as derivatives say, the worst first.
std::vector<KnownValue> doubtfulValues(const BundleStart& start, const Fit& fit)
{
    const VectorXd values = parametersOf(fit.rig), known = parametersOf(start.rig);
    std::vector<std::pair<double, int>> columns;
    for (int i = 0; i < start.covariance.rows; i++)
    {
        const double before = start.covariance.at<double>(i, i), now = fit.covariance.at<double>(i, i);
        const double ratio = std::abs(values[i] - known[i])/std::sqrt(std::max(before - now, 1e-2*before));
        if (before > 0 && ratio > MANY)
            columns.push_back({-ratio, i});
    }
    std::sort(columns.begin(), columns.end());
    std::vector<KnownValue> doubtful;
    for (const auto& column : columns)
    {
        KnownValue value = valueAt(fit.rig, column.second);
        value.deviations = -column.first;
        const auto isSame = [&](const KnownValue& other) { return other.first == value.first; };
        if (std::none_of(doubtful.begin(), doubtful.end(), isSame))
            doubtful.push_back(value);
    }
    return doubtful;
}

//! By itself, and next to nothing.
BundleStart withUnknown(const KnownValue& value, const BundleStart& start)
{
    const double FREE = 100.;           // times the standard deviation
    BundleStart freed = start;
    const Rect own(value.first, value.first, value.count, value.count);
    const Mat block = start.covariance(own)*(FREE*FREE);
    freed.covariance = start.covariance.clone();
    freed.covariance.rowRange(value.first, value.first + value.count) = 0.;
    freed.covariance.colRange(value.first, value.first + value.count) = 0.;
    block.copyTo(freed.covariance(own));
    return freed;
}

//! By how many standard deviations what is found contradicts what was known.
double deviationsOf(const KnownValue& value, const BundleStart& start, const BundleAdjustment& adjustment, const Readjust& adjust)
{
    try
    {
        const BundleAdjustment freed = adjust(withUnknown(value, start));
        return std::sqrt(std::max(0., adjustment.costAt(freed.fit.sigma) - freed.costAt(freed.fit.sigma)));
    }
    catch (const Failure&)              // no fit without it
    {
        return value.deviations;
    }
}

} // namespace

std::string contradictionOf(const BundleStart& start, const BundleAdjustment& adjustment, const Readjust& adjust)
{
    for (const KnownValue& value : doubtfulValues(start, adjustment.fit))
    {
        const double deviations = deviationsOf(value, start, adjustment, adjust);
        if (deviations > MANY)
            return value.name + format(" is %.0f standard deviations from what the start says: it has changed since, or a given value "
                                       "is wrong", deviations);
    }
    return "";
}

} // namespace tools
