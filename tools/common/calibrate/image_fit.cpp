#include "calibrate/image_fit.hpp"
#include "calibrate/estimated_parameters.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! The moments that a fit with these flags learns from.
std::vector<int> usefulMoments(const RigData& data, int flags)
{
    std::vector<int> useful;
    for (int i = 0; i < (int)data.moments.size(); i++)
    {
        const Moment& m = data.moments[i];
        // Without glass a moment says something about R and T if both cameras see it, and about free lenses always.
        const bool bothDirect = data.cameraCount == 2 && m.hasDirect(0) && m.hasDirect(1);
        const bool any = m.hasGlass() || m.hasDirect(0) || m.hasDirect(1);      // else all its images were left out
        if (m.hasGlass() || bothDirect || (any && (flags & GLASS_FREE_INTRINSICS)))
            useful.push_back(i);
    }
    return useful;
}

//! As calibrateGlassRig wants them: per camera, per view.
std::vector<std::vector<Mat>> imagesOf(const RigData& data, const std::vector<int>& moments, bool glass)
{
    std::vector<std::vector<Mat>> images(data.cameraCount);
    for (int c = 0; c < data.cameraCount; c++)
        for (int i : moments)
            images[c].push_back(Mat((glass ? data.moments[i].glass : data.moments[i].direct)[c], true));
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
        rig.cameras[c]->setLensParameters(known.lens);
        GlassWindow window = rig.cameras[c]->window();
        if (known.covariance.rows > known.lens.rows)
        {
            window.thickness = known.thickness;
            window.index = known.index;
        }
        rig.cameras[c]->setWindow(window);
    }
}

std::vector<Mat> covariancesOf(const RigModel& rig)
{
    std::vector<Mat> covariances;
    for (const KnownCamera& known : rig.known)
        covariances.push_back(known.covariance);
    return covariances;
}

//! How many numbers are known with a covariance.
int countPriors(const RigModel& rig, int flags)
{
    int count = 0;
    for (size_t c = 0; c < rig.known.size(); c++)
    {
        const Mat covariance = rig.known[c].covariance;
        const int lens = rig.known[c].lens.rows;
        const bool ownsWindow = c == 0 || !(flags & GLASS_SHARED_WINDOW);
        for (int i = 0; i < covariance.rows && (i < lens || ownsWindow); i++)
            count += covariance.at<double>(i, i) > 0;
    }
    return count;
}

} // namespace

Fit fitImages(const RigData& data, const RigModel& start, const std::vector<int>& moments, int flags, int maxIterations)
{
    Fit fit;
    fit.rig = start.clone();
    startAtKnown(fit.rig);
    fit.moments = moments;
    const bool stereo = data.cameraCount == 2;
    std::vector<int> windows = {0};
    std::vector<Mat> Rs = {Mat::eye(3, 3, CV_64F)}, Ts = {Mat::zeros(3, 1, CV_64F)};
    int rigFlags = flags & ~GLASS_SHARED_WINDOW;
    if (stereo)
    {
        windows.push_back(flags & GLASS_SHARED_WINDOW ? 0 : 1);
        Rs.push_back(Mat(fit.rig.R, true));
        Ts.push_back(Mat(fit.rig.T, true));
        rigFlags |= GLASS_FREE_EXTRINSICS;
    }
    fit.rms = calibrateGlassRig(std::vector<std::vector<Point3d>>(moments.size(), data.objectPoints),
                                imagesOf(data, moments, false), imagesOf(data, moments, true), fit.rig.cameras, windows, Rs, Ts,
                                fit.rvecs, fit.tvecs, fit.stdDeviations, fit.covariance, noArray(), fit.imageStatus,
                                fit.inliers, fit.otherMinima, rigFlags, noArray(),
                                TermCriteria(TermCriteria::COUNT + TermCriteria::EPS,
                                             flags & GLASS_ROBUST ? std::min(maxIterations, MAX_ROBUST_ITERATIONS) : maxIterations,
                                             1e-12),
                                covariancesOf(fit.rig));
    if (stereo)
    {
        fit.rig.R = Rs[1];
        fit.rig.T = Ts[1];
    }
    int points = 0;
    for (const Mat& used : fit.inliers)
        points += used.empty() ? 0 : countNonZero(used);
    const size_t free = estimatedWindowParameters(fit, flags).size() + estimatedRigParameters(fit).size();
    fit.freedom = 2.*points + countPriors(fit.rig, flags) - (double)free - 6.*(double)moments.size();
    fit.sigma = fit.rms*std::sqrt(points/fit.freedom);
    return fit;
}

Fit fitAllImages(const RigData& data, const RigModel& start, const std::vector<LensSource>& lensSources, int& flags)
{
    const Fit held = fitImages(data, start, usefulMoments(data, flags), flags);
    const bool fromImages = std::any_of(lensSources.begin(), lensSources.end(),
                                        [](const LensSource& s) { return s.kind != LensSource::FROM_FILE; });
    if (!fromImages || (flags & GLASS_FREE_INTRINSICS))
        return held;
    flags |= GLASS_FREE_INTRINSICS;
    Fit fit = fitImages(data, held.rig, usefulMoments(data, flags), flags);
    fit.otherMinima = held.otherMinima;     // only looked for while the lens is held
    return fit;
}

} // namespace tools
