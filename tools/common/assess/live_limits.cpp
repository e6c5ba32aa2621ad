// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/live_limits.hpp"
#include "assess/advice.hpp"
#include "calibrate/estimated_parameters.hpp"
#include "calibrate/image_fit.hpp"
#include "console/failure.hpp"
#include "measure/point_error.hpp"

#include <cmath>

using cv::format;

namespace tools {

namespace {

const int LEAST_PAIRS = 3;              // of each camera: the noise is not known from fewer
const int LEAST_GLASS_ONLY = 8;         // without pairs

bool areFew(const RigData& data)
{
    for (int k = 0; k < data.cameraCount; k++)
    {
        int glass = 0;
        for (const View& view : data.views)
            glass += view.hasGlass(k);
        if (data.countPairs(k) < LEAST_PAIRS && glass < LEAST_GLASS_ONLY)
            return true;
    }
    return false;
}

void fitQuickly(RigCalibration& c)
{
    c.outliers = startWithoutOutliers(c.data, c.options, c.start, c.lensSources);
    c.fit = fitAllImages(c.data, c.start, c.lensSources, c.options.flags);
}

void add(Progressed& progressed, const std::string& text) { progressed.words += (progressed.words.empty() ? "" : ", ") + text; }

//! True if there are limits and all are met.
bool compareWithLimits(const RigCalibration& c, Progressed& progressed)
{
    bool met = c.limits.normalStdDeg > 0 || !c.limits.errors.empty();
    for (int k = 0; k < c.data.cameraCount && c.limits.normalStdDeg > 0; k++)
    {
        const double std = windowStd(c.fit, k).normalDeg[0];
        met = met && std <= c.limits.normalStdDeg;
        add(progressed, (c.data.cameraCount > 1 ? format("camera %d: ", k + 1) : "") + format("normal +- %.3g of %g deg", std,
                                                                                             c.limits.normalStdDeg));
    }
    Calibration calibration = calibrationOf(c.fit.rig);
    calibration.covariance = c.fit.covariance;
    for (const ErrorLimit& limit : c.limits.errors)
    {
        const double error = mapErrors(calibration, limit.range, c.fit.sigma, ERROR_MAP_COLUMNS).worst();
        met = met && error <= limit.error;
        add(progressed, format("error at %g %s %.3g of %g", limit.range, c.unit.c_str(), error, limit.error));
    }
    return met;
}

bool isNextWorthLittle(const RigCalibration& c, double leastGain, Progressed& progressed)
{
    const Advice advice = adviseImages(c);
    if (advice.pairs.empty())
        return false;
    const double gain = 1 - advice.pairs[0].quality.calibrationPart/advice.now.calibrationPart;
    add(progressed, format("the best next pair would take %.1f %% off the calibration's part of a point's error", 100*gain));
    return gain < leastGain;
}

} // namespace

Progressed progressOf(RigCalibration c, double leastGain)
{
    Progressed progressed;
    if (areFew(c.data))
        return progressed;
    try
    {
        fitQuickly(c);
        progressed.isEnough = compareWithLimits(c, progressed);
        if (!progressed.isEnough && leastGain > 0)
            progressed.isEnough = isNextWorthLittle(c, leastGain, progressed);
    }
    catch (const std::exception&)       // cv::Exception is one: these images do not determine all yet
    {
        return {};
    }
    if (!progressed.words.empty())
        progressed.words = "so far: " + progressed.words + (progressed.isEnough ? ": enough" : "");
    return progressed;
}

} // namespace tools
