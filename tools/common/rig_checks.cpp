#include "rig_checks.hpp"
#include "progress.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int MIN_LENS_VIEWS = 3;       // to calibrate a pinhole camera from a flat board

//! RMS px with the pose of each board fitted to its one image.
class PooledRms
{
public:
    void add(const std::vector<Point3d>& object, const std::vector<Point2d>& pixels, const Ptr<RefractiveCamera>& camera)
    {
        if (pixels.empty())
            return;
        Vec3d rvec, tvec;
        const double rms = refractiveSolvePnP(object, pixels, camera, rvec, tvec);
        const int n = (int)std::count_if(pixels.begin(), pixels.end(), seen);
        sum_ += rms * rms * n;      // a view without a pose makes the whole NaN
        count_ += n;
    }
    double value() const { return count_ ? std::sqrt(sum_ / count_) : NONE; }
private:
    double sum_ = 0.;
    int count_ = 0;
};

//! Number of coefficients for cv::calibrateCamera, or -1 if the lens is none of its models.
int pinholeCoefficients(const RefractiveCamera& camera)
{
    return camera.lensModel() == "fisheye" ? -1 : camera.lensParameters().rows - 4;
}

Ptr<RefractiveCamera> pinholeThroughGlass(const RigData& data, int camera, const std::vector<int>& moments,
                                          int coefficients)
{
    std::vector<std::vector<Point2d>> views;
    for (int i : moments)
        if (data.moments[i].hasGlass(camera))
            views.push_back(data.moments[i].glass[camera]);
    double rms;
    return coefficients < 0 || (int)views.size() < MIN_LENS_VIEWS ? Ptr<RefractiveCamera>()
        : calibratePinhole(data.objectPoints, views, data.imageSize[camera], coefficients, rms);
}

double testWindow(const RigData& data, const Rig& start, int flags, const std::vector<int>& train,
                  const std::vector<int>& test)
{
    try
    {
        const Fit fit = fitRig(data, start, train, flags);
        PooledRms rms;
        for (int c = 0; c < data.cameraCount; c++)
            for (int i : test)
                rms.add(data.objectPoints, data.moments[i].glass[c], fit.rig.cameras[c]);
        return rms.value();
    }
    catch (const cv::Exception&)
    {
        return NONE;                // this half alone does not determine the window
    }
}

double testPinhole(const RigData& data, const Rig& start, const std::vector<int>& train, const std::vector<int>& test)
{
    try
    {
        PooledRms rms;
        for (int c = 0; c < data.cameraCount; c++)
        {
            const Ptr<RefractiveCamera> camera =
                pinholeThroughGlass(data, c, train, pinholeCoefficients(*start.cameras[c]));
            if (!camera)
                return NONE;
            for (int i : test)
                rms.add(data.objectPoints, data.moments[i].glass[c], camera);
        }
        return rms.value();
    }
    catch (const cv::Exception&)
    {
        return NONE;
    }
}

//! Range of the board's middle from camera 1.
double rangeOf(const RigData& data, const Fit& fit, size_t k)
{
    Point3d middle;
    for (const Point3d& X : data.objectPoints)
        middle += X * (1. / data.objectPoints.size());
    Matx33d R;
    Rodrigues(fit.rvecs[k], R);
    return norm(R * Vec3d(middle) + fit.tvecs[k]);
}

double angleDeg(const Vec3d& a, const Vec3d& b)
{
    return std::atan2(norm(a.cross(b)), a.dot(b)) * 180. / CV_PI;
}

//! RMS px between the two images of each corner of a pair: what ignoring the glass costs if the board cannot give way.
double shiftOfPairs(const RigData& data, int camera)
{
    double sum = 0.;
    int count = 0;
    for (const Moment& m : data.moments)
        for (size_t i = 0; m.isPair(camera) && i < m.glass[camera].size(); i++)
        {
            const Point2d d = m.glass[camera][i] - m.direct[camera][i];
            if (!seen(d))
                continue;
            sum += d.dot(d);
            count++;
        }
    return count ? std::sqrt(sum / count) : NONE;
}

} // namespace

Baselines computeBaselines(const RigData& data, const Rig& start, const std::vector<LensSource>& lensSources)
{
    std::vector<int> all;
    for (size_t i = 0; i < data.moments.size(); i++)
        all.push_back((int)i);
    Baselines result;
    for (int c = 0; c < data.cameraCount; c++)
    {
        const Ptr<RefractiveCamera> pinhole = pinholeThroughGlass(data, c, all, pinholeCoefficients(*start.cameras[c]));
        const Ptr<RefractiveCamera> bare = withWindow(start.cameras[c], GlassWindow());
        PooledRms ignored, through;
        for (const Moment& m : data.moments)
        {
            ignored.add(data.objectPoints, m.glass[c], bare);
            if (pinhole)
                through.add(data.objectPoints, m.glass[c], pinhole);
        }
        // A lens that itself came from the glass images knows no "without".
        const bool airLens = lensSources[c].kind != LensSource::FROM_GLASS;
        result.glassIgnored.push_back(airLens ? ignored.value() : NONE);
        result.shift.push_back(shiftOfPairs(data, c));
        result.throughGlass.push_back(through.value());
    }
    return result;
}

NearFar crossValidate(const RigData& data, const Rig& start, const Fit& fit, int flags,
                      const std::vector<LensSource>& lensSources)
{
    NearFar result;
    for (const LensSource& source : lensSources)
        if (source.kind == LensSource::FROM_GLASS)
            return result;          // the start has seen all images: nothing is held out
    std::vector<std::pair<double, int>> byRange;
    std::vector<int> nearHalf, farHalf, directOnly;
    for (size_t k = 0; k < fit.moments.size(); k++)
    {
        const int i = fit.moments[k];
        if (data.moments[i].hasGlass())
            byRange.push_back({rangeOf(data, fit, k), i});
        else
            directOnly.push_back(i);
    }
    if (byRange.size() < 4)
        return result;
    std::sort(byRange.begin(), byRange.end());
    const size_t half = byRange.size() / 2;
    for (size_t k = 0; k < byRange.size(); k++)
        (k < half ? nearHalf : farHalf).push_back(byRange[k].second);
    result.done = true;
    result.nearRange[0] = byRange.front().first;
    result.nearRange[1] = byRange[half - 1].first;
    result.farRange[0] = byRange[half].first;
    result.farRange[1] = byRange.back().first;

    auto withDirect = [&directOnly](std::vector<int> moments) {
        moments.insert(moments.end(), directOnly.begin(), directOnly.end());
        return moments;
    };
    result.windowNearToFar = testWindow(data, start, flags, withDirect(nearHalf), farHalf);
    result.windowFarToNear = testWindow(data, start, flags, withDirect(farHalf), nearHalf);
    result.pinholeNearToFar = testPinhole(data, start, nearHalf, farHalf);
    result.pinholeFarToNear = testPinhole(data, start, farHalf, nearHalf);
    return result;
}

std::vector<Influence> leaveOneOut(const RigData& data, const Fit& fit, int flags, bool quiet)
{
    std::vector<Influence> result;
    for (int i : fit.moments)
        if (data.moments[i].hasGlass())
            result.push_back({i, {NONE, NONE}});
    if (result.size() < 3)
        return {};
    Progress progress("leaving out one view at a time", (int)result.size(), quiet);
    for (Influence& influence : result)
    {
        std::vector<int> others = fit.moments;
        others.erase(std::find(others.begin(), others.end(), influence.moment));
        try
        {
            const Fit without = fitRig(data, fit.rig, others, flags);
            for (int c = 0; c < data.cameraCount; c++)
                influence.turnDeg[c] = angleDeg(fit.rig.cameras[c]->window().normal,
                                                without.rig.cameras[c]->window().normal);
        }
        catch (const cv::Exception&) {}     // the others alone do not determine the window: stays NaN
        progress.step();
    }
    return result;
}

} // namespace tools
