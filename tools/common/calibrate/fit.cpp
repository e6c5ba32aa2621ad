// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/fit.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/refit.hpp"
#include "calibrate/window_face.hpp"
#include "window/parameters.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

std::string textOf(const CalibrationError& e, const RigData& data, const std::vector<int>& views)
{
    const View* const view = e.view < 0 ? nullptr : &data.views[views.at(e.view)];
    switch (e.cause)
    {
    case CalibrationError::NOT_CONVERGED:
        return (view ? "view '" + view->stem + "': " : std::string()) + e.reason;
    case CalibrationError::NO_POSE:
        return "view '" + view->stem + "': " + e.reason;
    case CalibrationError::NO_IMAGE:
    {
        const Point3d X = view->objectPoints.at(e.point) + Point3d(data.origin.origin());
        return cv::format("view '%s' of camera %d, point (%g, %g, %g): ", view->stem.c_str(), e.camera + 1, X.x, X.y, X.z) + e.reason +
            "; check --distance, --thickness, the lens, the units, and --poses if given";
    }
    case CalibrationError::WINDOW_NOT_SEEN:
        return "the --glass" + cameraSuffix(e.camera) + " images have no point that was seen";
    case CalibrationError::PAIRS_SWAPPED:
        return "the --direct images and the --glass images are swapped: " + e.reason + "; direct is what was seen without the window";
    case CalibrationError::PAIRS_CONTRADICT:
        return e.reason + ". The --direct image and the --glass image of a pair must show the same target that was not moved in "
            "between, its points in the same order; of a hand-held board say --unpaired";
    default:
        return e.err;
    }
}

//! The views that give information to a fit with these flags.
std::vector<int> usefulViews(const RigData& data, int flags)
{
    std::vector<int> useful;
    for (int i = 0; i < (int)data.views.size(); i++)
    {
        const View& view = data.views[i];
        // Without glass a view says something about R and T if several cameras see it, and about free lenses always.
        const bool any = view.hasGlass() || view.countDirect() > 0; // else all its images were left out
        if (view.hasGlass() || view.countDirect() > 1 || (any && (flags & GLASS_FREE_INTRINSICS)))
            useful.push_back(i);
    }
    return useful;
}

//! As calibrateGlassRig wants them: per camera, per view.
std::vector<std::vector<Mat>> imagesOf(const RigData& data, const std::vector<int>& views, bool glass)
{
    std::vector<std::vector<Mat>> images(data.cameraCount);
    for (int c = 0; c < data.cameraCount; c++)
        for (int i : views)
            images[c].push_back(Mat((glass ? data.views[i].glass : data.views[i].direct)[c], true));
    return images;
}

//! The cameras start at what is known of them: the prior's centre must not follow an earlier fit.
void startAtKnown(RigModel& rig)
{
    for (size_t c = 0; c < rig.known.size(); c++)
    {
        const KnownCamera& known = rig.known[c];
        if (known.covariance.empty())
            continue;
        Mat lens = rig.cameras[c]->lensParameters().clone();
        for (int i = 0; i < lens.rows; i++)
            if (known.covariance.rows > lens.rows || !std::isnan(known.covariance.at<double>(i, i)))
                lens.at<double>(i) = known.lens.at<double>(i);
        rig.cameras[c]->setLensParameters(lens);
        if (known.covariance.rows == lens.rows)
            continue;
        std::vector<double> window = windowParameters(rig.cameras[c]->window());
        const std::vector<double> knownWindow = windowParameters(known.window);
        CV_Assert(knownWindow.size() == window.size());
        const auto isKnown = [&](int i) { return known.covariance.at<double>(lens.rows + i, lens.rows + i) > 0; };
        const bool isNormalKnown = !isRound(known.window) && (isKnown(0) || isKnown(1) || isKnown(2));
        for (int i = 0; i < (int)window.size(); i++)
            if (isKnown(i) || (i < 3 && isNormalKnown))
                window[i] = knownWindow[i];
        rig.cameras[c]->setWindow(withParameters(rig.cameras[c]->window(), window.data()));
    }
}

/** What is known of each camera in a fit with these flags. In one that holds lenses, what a lens choice left out (only that is known of a
lens of which else nothing is) is held with the rest. */
std::vector<Mat> covariancesOf(const RigModel& rig, int flags)
{
    std::vector<Mat> covariances;
    for (const KnownCamera& known : rig.known)
    {
        covariances.push_back(known.covariance);
        const bool isLensUnknown = !known.covariance.empty() && std::isnan(known.covariance.at<double>(0, 0));
        if (!isLensUnknown || (flags & GLASS_FREE_INTRINSICS))
            continue;
        covariances.back() = known.covariance.clone();
        Mat lens = covariances.back()(Rect(0, 0, known.lens.rows, known.lens.rows));
        lens.setTo(0);
        lens.diag().setTo(NAN);
    }
    return covariances;
}

} // namespace

void poseInCamera(const Fit& fit, size_t k, int camera, Vec3d& rvec, Vec3d& tvec)
{
    rvec = fit.rvecs[k];
    tvec = fit.tvecs[k];
    poseInCamera(fit.rig, camera, rvec, tvec);
}

std::vector<Residual> residualsOf(const RigData& data, const Fit& fit)
{
    std::vector<Residual> residuals;
    for (int c = 0; c < data.cameraCount; c++)
    {
        const Ptr<RefractiveCamera> through = fit.rig.cameras[c], bare = copyWithWindow(through, GlassWindow());
        for (size_t k = 0; k < fit.views.size(); k++)
        {
            for (bool glass : {true, false})
            {
                Vec3d rvec = fit.rvecs[k], tvec = fit.tvecs[k];
                poseInImage(fit.rig, c, glass, rvec, tvec);
                const View& view = data.views[fit.views[k]];
                const std::vector<Point2d>& pixels = glass ? view.glass[c] : view.direct[c];
                if (pixels.empty())
                    continue;
                std::vector<Point2d> modelled;
                refractiveProjectPoints(pointsOfTarget(fit.rig, view.objectPoints), rvec, tvec, glass ? through : bare, modelled);
                for (size_t i = 0; i < pixels.size(); i++)
                    if (seen(pixels[i]))
                        residuals.push_back({c, fit.views[k], glass, pixels[i], pixels[i] - modelled[i]});
            }
        }
    }
    return residuals;
}

/** The library's error with a text (err) in the tools' words: views by the names of their files, options in place of arguments.
@param views of the data, which the library was given */
static CalibrationError inToolsWords(const CalibrationError& error, const RigData& data, const std::vector<int>& views)
{
    CalibrationError said = error;
    said.err = textOf(error, data, views);
    said.formatMessage();
    return said;
}

Fit fitImages(const RigData& data, const RigModel& start, const std::vector<int>& views, int flags, int maxIterations)
{
    Fit fit;
    fit.rig = start.clone();
    startAtKnown(fit.rig);
    fit.views = views;
    std::vector<std::vector<Point3d>> objectPoints;
    GlassRigOptions options(data.cameraCount == 1 ? flags : flags | GLASS_FREE_EXTRINSICS);
    for (int i : views)
    {
        const View& view = data.views[i];
        objectPoints.push_back(view.objectPoints);
        if (!(flags & GLASS_USE_POSES))
            continue;
        fit.rvecs.push_back(view.pose->rvec);
        fit.tvecs.push_back(view.pose->tvec);
        options.poseCovariances.push_back(view.pose->covariance);
    }
    std::vector<Mat> Rs, Ts;
    Mat_<double> targetErrors;
    for (int c = 0; c < data.cameraCount; c++)
    {
        Rs.push_back(Mat(fit.rig.extrinsics[c].R, true));
        Ts.push_back(Mat(fit.rig.extrinsics[c].t, true));
    }
    options.criteria.maxCount = flags & GLASS_ROBUST ? std::min(maxIterations, MAX_ROBUST_ITERATIONS) : maxIterations;
    options.cameraCovariances = covariancesOf(fit.rig, flags);
    options.targetCovariance = fit.rig.targetCovariance;
    try
    {
        const GlassRigResult result = fitGlassRig(objectPoints, imagesOf(data, views, false), imagesOf(data, views, true),
                                                  fit.rig.cameras, fit.rig.windows, Rs, Ts, fit.rvecs, fit.tvecs, options);
        setEstimate(result, fit);
        fit.imageStatus = result.imageStatus;
        fit.inliers = result.inliers;
        fit.otherMinima = result.otherMinima;
        targetErrors = result.targetErrors;
    }
    catch (const CalibrationError& e)
    {
        throw inToolsWords(e, data, views);
    }
    for (int c = 1; c < data.cameraCount; c++)
    {
        fit.rig.extrinsics[c] = {Rs[c], Ts[c]};
    }
    if (!fit.rig.targetCovariance.empty())
    {
        fit.rig.targetScale = 1. + targetErrors(0);
        fit.rig.targetMotion = {rotationMatrix(Vec3d(targetErrors[1])), Vec3d(targetErrors[4])};
    }
    fit.withTargets = fit.covariance;
    const int count = columnCount(fit.rig);
    fit.stdDeviations = fit.stdDeviations.rowRange(0, count).clone();
    fit.covariance = fit.covariance(Rect(0, 0, count, count)).clone();
    return fit;
}

bool isOnlyMinimum(const RigData& data, const Fit& fit, int flags)
{
    const bool isSearched = data.cameraCount > 1 && !(flags & (GLASS_FREE_INTRINSICS | GLASS_USE_POSES))
        && std::none_of(data.views.begin(), data.views.end(), [](const View& view) { return view.countDirect() > 0; });
    return isSearched && countNonZero(fit.otherMinima == fit.otherMinima) == 0;     // NaN: there is none
}

Fit fitAllImages(const RigData& data, const RigModel& start, const std::vector<LensSource>& lensSources, int& flags,
                 int maxIterations, bool isPlaced)
{
    const Fit held = fitImages(data, start, usefulViews(data, flags), flags | (isPlaced ? FROM_EARLIER_FIT : 0), maxIterations);
    const bool fromImages = std::any_of(lensSources.begin(), lensSources.end(),
                                        [](const LensSource& s) { return s.kind != LensSource::FROM_FILE; });
    if (!fromImages || (flags & GLASS_FREE_INTRINSICS))
        return held;
    flags |= GLASS_FREE_INTRINSICS;
    Fit fit = fitImages(data, held.rig, usefulViews(data, flags), flags, maxIterations);
    fit.otherMinima = held.otherMinima;     // only looked for while the lens is held
    return fit;
}

} // namespace tools
