// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/plain_fit.hpp"
#include "calibrate/fit.hpp"
#include "calibrate/lens_choice.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/priors.hpp"
#include "console/numbers.hpp"
#include "measure/view_observations.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double CORNERS_PX = 2.;           // half of the corners are never farther off, in an image of usual size;
const double CORNERS_SHARE = 1./640.;   // in a larger one, of its longer side
const int SOON = 30;                    // iterations: what is right is fitted by fewer; a wrong guess may creep for a thousand

//! Object -> camera 1 by the first image that gives a pose: without the window if there is one, whose tilt is not known yet.
bool poseOf(const View& view, const RigModel& rig, Vec3d& rvec, Vec3d& tvec)
{
    for (bool glass : {false, true})
        for (int c = 0; c < (int)rig.cameras.size(); c++)
        {
            const std::vector<Point2d>& pixels = (glass ? view.glass : view.direct)[c];
            if (pixels.empty() || !refractiveSolvePnP(view.objectPoints, pixels, glass ? rig.cameras[c]
                                                      : copyWithWindow(rig.cameras[c], GlassWindow()), rvec, tvec))
                continue;
            poseInCamera1(rig, c, rvec, tvec);
            return true;
        }
    return false;
}

//! Of each number of the cameras and their places: 1 if a fit estimates it without knowing anything of it, else 0.
std::vector<double> freeNumbers(const RigModel& rig, const std::vector<LensSource>& lensSources, int flags)
{
    std::vector<double> free(columnCount(rig), 0.);
    const auto set = [&free](int first, int count, bool isFree) {
        for (int i = first; i < first + count; i++)
            free[i] = isFree; };
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        set(at.lens, at.lensCount, lensSources[c].kind != LensSource::FROM_FILE || (flags & GLASS_FREE_INTRINSICS));
        if (c > 0)
            set(extrinsicsColumn(rig, c), 6, true);
        if (!rig.ownsWindow(c))
            continue;
        set(at.distance, 1, flags & GLASS_FREE_DISTANCE);
        set(at.thickness, at.layers, flags & GLASS_FREE_THICKNESS);
        set(at.index, at.layers, flags & GLASS_FREE_INDEX);
        set(at.outerIndex, 1, flags & GLASS_FREE_OUTER_INDEX);
    }
    return free;
}

int countSeen(const View& view, int cameras)
{
    int count = 0;
    for (int c = 0; c < cameras; c++)
        for (const std::vector<Point2d>* pixels : {&view.direct[c], &view.glass[c]})
            count += (int)std::count_if(pixels->begin(), pixels->end(), seen);
    return count;
}

const int ITERATIONS = 40, RATIONAL_ITERATIONS = 400;       // whose coefficients make up for each other, so that a fit creeps
const double LEFT_BY_CAUSE = 0.8;       // of the residuals, at most, if a wrong value is what is wrong,
const double CLEAN = 1.3;               // and no more than this times what each image has by itself

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

/** Lenses, places and windows of a start, each board where its first image has it, and deviations of 1 for what a fit would estimate.
@param start of startModel. @param flags GlassCalibrationFlags */
static Fit unfitted(const RigData& data, const RigModel& start, const std::vector<LensSource>& lensSources, int flags)
{
    Fit fit;
    fit.rig = start.clone();
    for (int i = 0; i < (int)data.views.size(); i++)
    {
        const View& view = data.views[i];
        Vec3d rvec, tvec;
        if ((flags & GLASS_USE_POSES) && view.pose)
            rvec = view.pose->rvec, tvec = view.pose->tvec;
        else if (!poseOf(view, start, rvec, tvec))
            continue;
        fit.views.push_back(i);
        fit.rvecs.push_back(rvec);
        fit.tvecs.push_back(tvec);
        fit.dof += 2.*countSeen(view, data.cameraCount) - (flags & GLASS_USE_POSES ? 0. : 6.);
    }
    const std::vector<double> free = freeNumbers(start, lensSources, flags);
    fit.stdDeviations = Mat(free, true);
    fit.dof -= std::accumulate(free.begin(), free.end(), 0.) + 2.*countWindows(start);      // and a normal of each window
    double squares = 0.;
    const std::vector<Residual> residuals = residualsOf(data, fit);
    for (const Residual& r : residuals)
        squares += r.error.dot(r.error);
    fit.sigma = std::sqrt(squares/std::max(1., fit.dof));
    return fit;
}

double noiseOfImages(const CalibrationInput& input)
{
    try
    {
        std::vector<LensSource> sources;
        return imageNoise(startModel(input.data, exactly(input.options), sources), input.data.views).sigma;
    }
    catch (const std::exception&)       // no start
    {
        return 0.;
    }
}

PlainFit fitPlainly(const CalibrationInput& input, const std::optional<RigModel>& found)
{
    PlainFit plain;
    try
    {
        std::vector<LensSource> sources;
        RigOptions exact = exactly(input.options);      // where a value is far off, a fit within what is known of it creeps
        for (GivenPlace& place : exact.places)
            place.covariance = Matx44d::zeros();
        RigOptions options = input.options;
        const RigModel start = startModel(input.data, exact, sources, found ? &*found : nullptr);
        plain.noise = imageNoise(start, input.data.views).sigma;
        try
        {
            const int iterations = options.lensCoefficients > POLYNOMIAL_LENS ? RATIONAL_ITERATIONS : ITERATIONS;
            const Fit fit = fitAllImages(input.data, start, sources, options.flags, iterations, found.has_value());
            plain.noise = std::min(plain.noise, imageNoise(fit.rig, input.data.views).sigma);
            plain.px = medianCornerError(input.data, residualsOf(input.data, fit));
            if (isOnlyMinimum(input.data, fit, options.flags))
                plain.only = fit.rig;
            plain.explained = causeOf(input.data, options, withKnown(input.data, fit, options), fit.sigma);
        }
        catch (const CalibrationError& e)
        {
            plain.isUndetermined = e.cause == CalibrationError::UNDETERMINED;
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
