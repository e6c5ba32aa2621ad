#include "calibrate_rig.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int MIN_PAIRS = 3;        // to refine a lens together with the window
const double SPOILT = 1.2;      // RMS of the direct images after / before the refinement, where it has failed
const int MAX_ITERATIONS = 1000;

double directRms(const RigData& data, const Fit& fit, int camera)
{
    double sum = 0.;
    int count = 0;
    for (const Residual& r : residualsOf(data, fit))
        if (r.camera == camera && !r.glass)
        {
            sum += r.error.dot(r.error);
            count++;
        }
    return std::sqrt(sum / count);
}

} // namespace

std::vector<int> usefulMoments(const RigData& data, int flags)
{
    std::vector<int> useful;
    for (int i = 0; i < (int)data.moments.size(); i++)
    {
        const Moment& m = data.moments[i];
        // Without glass a moment says something about R and T if both cameras see it, and about free lenses always.
        const bool bothDirect = data.cameraCount == 2 && m.hasDirect(0) && m.hasDirect(1);
        if (m.hasGlass() || bothDirect || (flags & GLASS_FREE_INTRINSICS))
            useful.push_back(i);
    }
    return useful;
}

Fit fitRig(const RigData& data, const Rig& start, const std::vector<int>& moments, int flags)
{
    Fit fit;
    fit.rig = start.clone();
    fit.moments = moments;
    const std::vector<std::vector<Point3d>> object(moments.size(), data.objectPoints);
    std::vector<std::vector<Point2d>> direct[2], glass[2];
    for (int i : moments)
        for (int c = 0; c < 2; c++)
        {
            direct[c].push_back(data.moments[i].direct[c]);
            glass[c].push_back(data.moments[i].glass[c]);
        }
    std::vector<Ptr<RefractiveCamera>>& cameras = fit.rig.cameras;
    const TermCriteria criteria(TermCriteria::COUNT + TermCriteria::EPS, MAX_ITERATIONS, 1e-12);
    if (data.cameraCount == 1)
        fit.rms = calibrateGlass(object, glass[0], direct[0], cameras[0], fit.rvecs, fit.tvecs, fit.stdDeviations,
                                 fit.covariance, fit.perViewErrors, noArray(), flags, criteria);
    else
        fit.rms = stereoCalibrateGlass(object, glass[0], direct[0], glass[1], direct[1], cameras[0], cameras[1],
                                       fit.rig.R, fit.rig.T, fit.rvecs, fit.tvecs, fit.stdDeviations, fit.covariance,
                                       fit.perViewErrors, flags | GLASS_FREE_EXTRINSICS, criteria);
    const int points = (int)residualsOf(data, fit).size();
    const size_t free = freeWindowParameters(fit, flags).size() + freeRigParameters(fit).size();
    fit.freedom = 2. * points - (double)free - 6. * (double)moments.size();
    fit.sigma = fit.rms * std::sqrt(points / fit.freedom);
    return fit;
}

Fit fitAll(const RigData& data, const Rig& start, const std::vector<LensSource>& lensSources, int& flags)
{
    const Fit fit = fitRig(data, start, usefulMoments(data, flags), flags);
    for (int c = 0; c < data.cameraCount; c++)
        if (lensSources[c].kind != LensSource::FROM_DIRECT || data.countPairs(c) < MIN_PAIRS)
            return fit;
    try
    {
        const int freed = flags | GLASS_FREE_INTRINSICS;
        const Fit refined = fitRig(data, fit.rig, usefulMoments(data, freed), freed);
        for (int c = 0; c < data.cameraCount; c++)
            if (directRms(data, refined, c) > SPOILT * lensSources[c].rms)
                return fit;     // a wrong thickness or index must not spoil the lens
        flags = freed;
        return refined;
    }
    catch (const cv::Exception&)
    {
        return fit;         // too few or too similar views to refine the lens; its own calibration stands
    }
}

void poseInCamera(const Rig& rig, int camera, Vec3d& rvec, Vec3d& tvec)
{
    if (camera == 0)
        return;
    Matx33d R;
    Rodrigues(rvec, R);
    Rodrigues(rig.R * R, rvec);
    tvec = rig.R * tvec + rig.T;
}

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
        const Ptr<RefractiveCamera> through = fit.rig.cameras[c], bare = withWindow(through, GlassWindow());
        for (size_t k = 0; k < fit.moments.size(); k++)
        {
            Vec3d rvec, tvec;
            poseInCamera(fit, k, c, rvec, tvec);
            for (bool glass : {true, false})
            {
                const Moment& m = data.moments[fit.moments[k]];
                const std::vector<Point2d>& pixels = glass ? m.glass[c] : m.direct[c];
                if (pixels.empty())
                    continue;
                std::vector<Point2d> modelled;
                refractiveProjectPoints(data.objectPoints, rvec, tvec, glass ? through : bare, modelled);
                for (size_t i = 0; i < pixels.size(); i++)
                    if (seen(pixels[i]))
                        residuals.push_back({c, fit.moments[k], glass, pixels[i], pixels[i] - modelled[i]});
            }
        }
    }
    return residuals;
}

} // namespace tools
