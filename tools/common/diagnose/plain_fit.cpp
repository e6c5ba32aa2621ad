// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/plain_fit.hpp"
#include "diagnose/unfitted.hpp"
#include "calibrate/image_fit.hpp"
#include "calibrate/parameter_columns.hpp"
#include "measure/rig_vector.hpp"
#include "measure/image_noise.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int ITERATIONS = 40;
const double LEFT_BY_CAUSE = 0.8;       // of the residuals, at most, if a wrong value is what is wrong,
const double CLEAN = 1.3;               // and no more than this times what each image has by itself

//! As exact: where a value is far off, a fit within what is known of it creeps.
RigOptions exactly(RigOptions options)
{
    options.std = GivenStd();
    for (GivenPlace& place : options.places)
        place.covariance = Matx44d::zeros();
    options.window.wedge.clear();
    if (options.window.shape == WINDOW_BENT)
        options.window.shape = WINDOW_FLAT;
    return options;
}

//! The same fit, with what is known of the values that it took as exact.
Fit withKnown(const RigData& data, const Fit& exact, const RigOptions& options)
{
    Fit fit = exact;
    fit.rig = exact.rig.clone();
    std::vector<double> deviations;
    for (int c = 0; c < data.cameraCount; c++)
    {
        const ParameterColumns before = columnsOf(exact.rig, c);
        GlassWindow window = exact.rig.cameras[c]->window();
        window.wedge = options.window.wedge;
        window.shape = options.window.shape;
        fit.rig.cameras[c]->setWindow(window);
        const Mat lens = exact.rig.known.empty() ? Mat() : exact.rig.known[c].lens;
        KnownCamera known = knownOf(*fit.rig.cameras[c], options, c);
        if (!lens.empty())
            known.lens = lens;
        fit.rig.known.resize(data.cameraCount);
        fit.rig.known[c] = known;
        const ParameterColumns at = columnsOf(*fit.rig.cameras[c]);
        for (int i = 0; i < at.end; i++)
        {
            const bool isNew = i >= before.end - before.lens;
            const double found = isNew ? 0. : exact.stdDeviations.at<double>(before.lens + i);
            const double variance = i < known.covariance.rows ? known.covariance.at<double>(i, i) : 0.;
            deviations.push_back(found > 0. ? found : variance > 0. ? std::sqrt(variance) : 0.);
        }
    }
    for (int i = extrinsicsColumn(exact.rig, 1); i < columnCount(exact.rig); i++)
        deviations.push_back(exact.stdDeviations.at<double>(i));
    fit.stdDeviations = Mat(deviations, true);
    fit.rig.targetCovariance = targetCovarianceOf(data, fit.rig, options.std);
    return fit;
}

//! A cause that explains all of the residuals of a fit.
std::optional<Contradiction> causeOf(const RigData& data, const RigOptions& options, const Fit& fit, double sigma)
{
    for (const Contradiction& c : testGivenValues(data, options, fit))
        if (c.isSure && c.sigma < LEFT_BY_CAUSE*sigma && c.sigma < CLEAN*c.singleImages)
            return c;
    return std::nullopt;
}

} // namespace

PlainFit fitPlainly(const CalibrationInput& input, const std::optional<RigModel>& found)
{
    PlainFit plain;
    try
    {
        std::vector<LensSource> sources;
        const RigOptions exact = exactly(input.options);
        RigOptions options = input.options;
        const RigModel start = startModel(input.data, exact, sources, found ? &*found : nullptr);
        plain.noise = imageNoise(start, input.data.views).sigma;
        try
        {
            const Fit fit = fitAllImages(input.data, start, sources, options.flags, ITERATIONS, found.has_value());
            plain.noise = std::min(plain.noise, imageNoise(fit.rig, input.data.views).sigma);
            plain.px = medianCornerError(input.data, residualsOf(input.data, fit));
            if (isOnlyMinimum(input.data, fit, options.flags))
                plain.only = fit.rig;
            plain.explained = causeOf(input.data, options, withKnown(input.data, fit, options), fit.sigma);
        }
        catch (const CalibrationError& e)
        {
            if (e.cause != CalibrationError::PAIRS_CONTRADICT)
                throw;
            options.flags = input.options.flags;
            const Fit fit = unfitted(input.data, start, sources, options.flags);
            plain.explained = causeOf(input.data, options, withKnown(input.data, fit, options), NO_FIT);
        }
    }
    catch (const std::exception&) {}    // no fit, or none to test
    return plain;
}

} // namespace tools
