// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/calibrate_images.hpp"
#include "calibrate/fit.hpp"
#include "calibrate/outliers.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "calibrate/rig_data.hpp"
#include "console/failure.hpp"
#include "diagnose/diagnosis.hpp"
#include "diagnose/plain_fit.hpp"

using namespace cv::refract;

namespace tools {

namespace {

const int FEW_ITERATIONS = 30;          // where a wrong value is known to be, a fit within what is known of it may creep;
const int FEW_ROBUST_ITERATIONS = 15;   // and where nothing fits, each of many

//! @param only see PlainFit
void findStart(RigCalibration& c, bool robust, int maxIterations, std::optional<RigModel>& only)
{
    if (robust)
        c.outliers = startWithoutOutliers(c.data, c.options, c.start, c.lensSources, maxIterations, only);
    else
        c.start = startModel(c.data, c.options, c.lensSources, only ? &*only : nullptr);
}

void fitWithBaselines(RigCalibration& c, const std::function<void()>& step, int maxIterations, bool isPlaced)
{
    c.fit = fitAllImages(c.data, c.start, c.lensSources, c.options.flags, maxIterations, isPlaced);
    c.residuals = residualsOf(c.data, c.fit);
    step();
    c.baselines = computeBaselines(c.data, c.start, c.lensSources);
    step();
}

//! The lens of a target with depth is searched for from many focal lengths, half a minute if its points are wrong.
bool isSlowToStart(const CalibrationInput& input)
{
    bool solid = false, known = true;
    for (const View& view : input.data.views)
        solid = solid || isSolid(view.objectPoints);
    for (int k = 0; k < input.data.cameraCount; k++)
        known = known && input.options.known[k];
    return solid && !known;
}

//! Coefficients of the lens that was chosen, or that were left out and may be anything that the images leave open.
bool carriesRational(const RigCalibration& c)
{
    for (int camera = 0; camera < c.data.cameraCount; camera++)
        if (!c.options.known[camera] && c.options.carriedCoefficients(camera) > POLYNOMIAL_LENS)
            return true;
    return false;
}

//! Not of what was given, but of where a fit ended.
bool isOfBadFit(CalibrationError::Cause cause)
{
    return cause == CalibrationError::NOT_CONVERGED || cause == CalibrationError::UNDETERMINED
        || cause == CalibrationError::PAIRS_CONTRADICT || cause == CalibrationError::PAIRS_SWAPPED
        || cause == CalibrationError::TOO_FEW_INLIERS;
}

} // namespace

void calibrateImages(RigCalibration& c, bool robust, const std::function<void()>& step)
{
    const CalibrationInput input{c.data, c.options, c.square, c.notices};
    if (!(c.options.flags & GLASS_USE_POSES))
        cameraLinks(c.data, false);         // throws where there are none: the first that cannot be, before causes of it are looked for
    // A wrong value makes good points look wrong, and the search for these long: so look first.
    PlainFit plain;
    bool fitsPlainly = true, mayFit = true;
    if (!isSlowToStart(input))
    {
        const MixUps mixUps = findMixUps(input);
        std::optional<RigModel> only;
        const bool lookedAtImages = requireNoMixUp(input, mixUps, only);
        plain = fitPlainly(input, only);
        if (plain.isUndetermined && !c.lens.scores.empty() && carriesRational(c))
            throw LensUndetermined("the images do not tell the coefficients of a rational lens: give --lens=opencv5");
        const bool suspicious = isSuspicious(input, plain);
        fitsPlainly = isSound(input, plain, suspicious);
        if (suspicious)
            requireNoCause(input, mixUps, plain, !lookedAtImages);
        if (!fitsPlainly || plain.explained)
            plain.only.reset();
    }
    const auto explained = [&](const auto& error, const std::string& reason) {
        return plain.explained ? reason + ": " + plain.explained->sentence : explainError(error, input); };
    try
    {
        findStart(c, robust && !plain.explained, fitsPlainly ? MAX_ROBUST_ITERATIONS : FEW_ROBUST_ITERATIONS, plain.only);
        step();
        // No mistake that is known of explains it. If wrong points do not either, a fit would creep for minutes.
        mayFit = fitsPlainly || medianErrorOfFit(c.data, c.options) < largestSoundError(c.data);
        const int iterations = !mayFit ? 1 : plain.explained ? FEW_ITERATIONS : MAX_ITERATIONS;        // one tells what has no fit at all
        fitWithBaselines(c, step, iterations, plain.only.has_value());
    }
    catch (const CalibrationError& e)
    {
        if (!mayFit && isOfBadFit(e.cause))
            refuseUnexplained(input, plain);
        throw Failure(mayFit ? explained(e, e.reason) : e.err);
    }
    catch (const cv::Exception& e)
    {
        throw Failure(mayFit ? explained(e.err, e.err) : e.err);
    }
    catch (const Failure& e)
    {
        if (isSlowToStart(input) || !mayFit)
            throw;
        throw Failure(explained(std::string(e.what()), e.what()));
    }
    if (!mayFit)
        refuseUnexplained(input, plain);
    requirePlausible(c.data, c.residuals, rmsOfSeparateFits(c.baselines, c.lensSources), input);
}

} // namespace tools
