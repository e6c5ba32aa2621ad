// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/given_values.hpp"
#include "calibrate/image_fit.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/table.hpp"
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double SURE = 6.;         // standard deviations; corners err a little together, so that they seem more sure than they are

//! One kind of value: how it is set free, and where it stands then.
struct GivenValue
{
    int flag;
    const char* word;
    const char* option;
    bool isGiven;
    double (*valueOf)(const GlassWindow&);
    int (*columnOf)(const ParameterColumns&);
};

std::vector<GivenValue> givenValues(const RigOptions& options)
{
    const GlassWindow& window = options.window;
    const bool oneLayer = window.thickness.size() == 1, equalMedia = window.innerIndex == window.outerIndex;
    return {
        {GLASS_FREE_THICKNESS, "thickness", "--thickness", oneLayer && options.thicknessStd == 0.,
         [](const GlassWindow& w) { return w.thickness[0]; }, [](const ParameterColumns& at) { return at.thickness; }},
        {GLASS_FREE_INDEX, "index", "--index", oneLayer && options.indexStd == 0.,
         [](const GlassWindow& w) { return w.index[0]; }, [](const ParameterColumns& at) { return at.index; }},
        {GLASS_FREE_DISTANCE, "distance", "--distance", !equalMedia,
         [](const GlassWindow& w) { return w.distance; }, [](const ParameterColumns& at) { return at.distance; }},
        {GLASS_FREE_OUTER_INDEX, "index of the scene's medium", "--outer-index", !equalMedia,
         [](const GlassWindow& w) { return w.outerIndex; }, [](const ParameterColumns& at) { return at.outerIndex; }}};
}

} // namespace

std::string Contradiction::sentence() const
{
    return "the images contradict " + option + format("=%.5g: set free, the %s would be ", given, what.c_str())
        + plusMinus(estimate, std) + format(", %.0f standard deviations away", std::abs(estimate - given)/std);
}

std::vector<Contradiction> contradictedValues(const RigCalibration& c)
{
    std::vector<Contradiction> contradictions;
    for (const GivenValue& given : givenValues(c.options))
    {
        if (!given.isGiven || (c.options.flags & given.flag))
            continue;
        try
        {
            const Fit fit = fitImages(c.data, c.fit.rig, c.fit.moments, c.options.flags | given.flag);
            const int windows = countWindows(c.fit.rig);
            for (int k = 0; k < c.data.cameraCount; k++)
            {
                if (!c.fit.rig.ownsWindow(k))
                    continue;
                const double before = given.valueOf(c.fit.rig.cameras[k]->window());
                const double estimate = given.valueOf(fit.rig.cameras[k]->window());
                const double std = fit.stdDeviations.at<double>(given.columnOf(columnsOf(fit.rig, k)));
                if (std::abs(estimate - before) > SURE*std)
                    contradictions.push_back({given.word + (windows == 1 ? std::string()
                                              : format(" of camera %d's window", k + 1)), given.option, before, estimate, std});
            }
        }
        catch (const cv::Exception&) {}     // the images do not determine it, so they do not contradict it either
    }
    return contradictions;
}

} // namespace tools
