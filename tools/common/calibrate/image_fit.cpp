// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/image_fit.hpp"
#include "calibrate/fit_error.hpp"
#include "calibrate/estimated_parameters.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/refit.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

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
        GlassWindow window = rig.cameras[c]->window();
        const ParameterColumns at = columnsOf(*rig.cameras[c]);
        const auto isKnown = [&](int column) { return at.has(column) && known.covariance.at<double>(column, column) > 0; };
        for (int i = 0; i < at.layers; i++)
        {
            if (isKnown(at.thickness + i))
                window.thickness[i] = known.window.thickness[i];
            if (isKnown(at.index + i))
                window.index[i] = known.window.index[i];
            if (at.wedge < at.curvature && isKnown(at.wedge + 2*i))
                window.wedge[i] = known.window.wedge[i];
        }
        if (isKnown(at.outerIndex))
            window.outerIndex = known.window.outerIndex;
        if (isKnown(at.normal))
            window.normal = known.window.normal;
        if (isKnown(at.distance))
            window.distance = known.window.distance;
        if (isKnown(at.radius))
            window.radius = known.window.radius;
        for (int i = 0; i < 3; i++)
            if (isKnown(at.center) && isKnown(at.center + i))
                window.center[i] = known.window.center[i];
        if (isKnown(at.curvature))
            window.curvature = known.window.curvature;
        rig.cameras[c]->setWindow(window);
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

//! How many numbers are known with a covariance, of each camera.
int countPriors(const RigModel& rig, const std::vector<Mat>& covariances)
{
    int count = 0;
    for (size_t c = 0; c < covariances.size(); c++)
    {
        const Mat covariance = covariances[c];
        const int lens = rig.known[c].lens.rows;
        const bool ownsWindow = rig.ownsWindow((int)c);
        const ParameterColumns at = columnsOf(*rig.cameras[c]);
        const auto isKnown = [&](int i) { return covariance.at<double>(i, i) > 0; };
        for (int i = 0; i < covariance.rows && (i < lens || ownsWindow); i++)
            count += isKnown(i) && !(i >= at.normal && i < at.normal + 3);
        if (ownsWindow && covariance.rows > lens && at.has(at.normal) && (isKnown(at.normal) || isKnown(at.normal + 1)))
            count += 2;                 // a direction of three numbers has two
    }
    return count;
}

} // namespace

Fit fitImages(const RigData& data, const RigModel& start, const std::vector<int>& views, int flags, int maxIterations)
{
    Fit fit;
    fit.rig = start.clone();
    startAtKnown(fit.rig);
    fit.views = views;
    std::vector<std::vector<Point3d>> objectPoints;
    std::vector<Mat> poseCovariances;
    for (int i : views)
    {
        const View& view = data.views[i];
        objectPoints.push_back(view.objectPoints);
        if (!(flags & GLASS_USE_POSES))
            continue;
        fit.rvecs.push_back(view.pose->rvec);
        fit.tvecs.push_back(view.pose->tvec);
        poseCovariances.push_back(view.pose->covariance);
    }
    const std::vector<Mat> cameraCovariances = covariancesOf(fit.rig, flags);
    std::vector<Mat> Rs, Ts;
    Mat_<double> targetErrors;
    for (int c = 0; c < data.cameraCount; c++)
    {
        Rs.push_back(Mat(fit.rig.extrinsics[c].R, true));
        Ts.push_back(Mat(fit.rig.extrinsics[c].T, true));
    }
    const TermCriteria criteria(TermCriteria::COUNT + TermCriteria::EPS,
                                flags & GLASS_ROBUST ? std::min(maxIterations, MAX_ROBUST_ITERATIONS) : maxIterations, 1e-12);
    try
    {
        fit.rms = fitGlassRig(objectPoints, imagesOf(data, views, false), imagesOf(data, views, true), fit.rig.cameras,
                              fit.rig.windows, Rs, Ts, fit.rvecs, fit.tvecs, fit.stdDeviations, fit.covariance, noArray(),
                              fit.imageStatus, fit.inliers, fit.otherMinima, fit.rig.targetCovariance, targetErrors,
                              data.cameraCount == 1 ? flags : flags | GLASS_FREE_EXTRINSICS, poseCovariances, criteria,
                              cameraCovariances);
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
    fit.covariance = fit.covariance(Rect(0, 0, count, count)).clone();
    int points = 0;
    for (const Mat& used : fit.inliers)
        points += used.empty() ? 0 : countNonZero(used);
    const size_t free = estimatedWindowParameters(fit).size() + estimatedRigParameters(fit).size();
    const size_t poses = flags & GLASS_USE_POSES ? 0 : views.size();        // known ones bring as many numbers as they have
    fit.dof = 2.*points + countPriors(fit.rig, cameraCovariances) - (double)free - 6.*(double)poses;
    fit.sigma = fit.rms*std::sqrt(points/fit.dof);
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
