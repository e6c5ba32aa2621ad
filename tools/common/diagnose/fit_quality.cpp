// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/fit_quality.hpp"
#include "calibrate/fit.hpp"
#include "console/numbers.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double CORNERS_PX = 2.;           // half of the corners are never farther off, in an image of usual size;
const double CORNERS_SHARE = 1./640.;   // in a larger one, of its longer side
const int SOON = 30;                    // iterations: what is right is fitted by fewer; a wrong guess may creep for a thousand

} // namespace

double medianCornerError(const RigData& data, const std::vector<Residual>& residuals)
{
    double worst = 0.;
    for (int c = 0; c < data.cameraCount; c++)
    {
        std::vector<double> lengths;
        for (const Residual& r : residuals)
            if (r.camera == c && data.views[r.view].hasGlass())
                lengths.push_back(std::isnan(r.error.x) ? NO_FIT : norm(r.error));
        worst = std::max(worst, median(lengths));
    }
    return worst;
}

double largestSoundError(const RigData& data)
{
    double limit = CORNERS_PX;
    for (int c = 0; c < data.cameraCount; c++)
        limit = std::max(limit, CORNERS_SHARE*std::max(data.imageSize[c].width, data.imageSize[c].height));
    return limit;
}

RigOptions exactly(RigOptions options)
{
    options.std = GivenStd();
    options.window.wedge.clear();
    if (options.window.shape == WINDOW_BENT)
        options.window.shape = WINDOW_FLAT;
    return options;
}

double medianErrorOfFit(const RigData& data, const RigOptions& given, Fit* result)
{
    try
    {
        // What is known of a value does not matter to pixels; a wedge or a bow that is free makes each iteration slow.
        const RigOptions options = exactly(given);
        std::vector<LensSource> sources;
        const Fit fit = fitImages(data, startModel(data, options, sources), allViews(data), options.flags, SOON);
        if (result)
            *result = fit;
        return medianCornerError(data, residualsOf(data, fit));
    }
    catch (const std::exception&)
    {
        return NO_FIT;
    }
}

} // namespace tools
