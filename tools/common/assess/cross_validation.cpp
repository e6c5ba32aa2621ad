// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/cross_validation.hpp"
#include "assess/measurement.hpp"
#include "calibrate/image_fit.hpp"
#include "calibrate/pinhole_rig.hpp"
#include "console/failure.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int FOLDS = 5;
const size_t MIN_HELD_OUT = 3;      // moments with a glass image, to hold any of them out

//! Range of the board's middle from camera 1.
double rangeOf(const RigData& data, const Fit& fit, size_t k)
{
    const std::vector<Point3d>& object = data.moments[fit.moments[k]].objectPoints;
    Point3d middle;
    for (const Point3d& X : object)
        middle += X*(1./object.size());
    Matx33d R;
    Rodrigues(fit.rvecs[k], R);
    return norm(R*Vec3d(middle) + fit.tvecs[k]);
}

//! Moments with a glass image, nearest board first; the others, which are never held out.
void splitMoments(const RigData& data, const Fit& fit, std::vector<std::pair<double, int>>& byRange, std::vector<int>& always)
{
    for (size_t k = 0; k < fit.moments.size(); k++)
    {
        const int i = fit.moments[k];
        if (data.moments[i].hasGlass())
            byRange.push_back({rangeOf(data, fit, k), i});
        else
            always.push_back(i);
    }
    std::sort(byRange.begin(), byRange.end());
}

//! A fit of some moments; no cameras if they do not determine it.
Fit trainWindow(const RigData& data, const Fit& fit, int flags, const std::vector<int>& train)
{
    try
    {
        return fitImages(data, fit.rig, train, flags);
    }
    catch (const cv::Exception&)
    {
        return Fit();
    }
}

RigModel trainPinhole(const RigData& data, const Fit& fit, const std::vector<int>& train)
{
    try
    {
        const Calibration pinhole = calibratePinholeRig(data, train, pinholeCoefficients(*fit.rig.cameras[0]));
        return modelOf(pinhole);
    }
    catch (const std::exception&)
    {
        return RigModel();       // too few images, or no such lens
    }
}

//! RMS of numbers that come in portions.
class Pool
{
public:
    void add(double error)
    {
        squares_ += error*error;
        sum_ += error;
        count_++;
    }
    double rms() const { return count_ ? std::sqrt(squares_/count_) : NONE; }
    double mean() const { return count_ ? sum_/count_ : NONE; }
private:
    double squares_ = 0., sum_ = 0.;
    int count_ = 0;
};

void addLengths(const RigModel& rig, const Moment& m, Pool& lengths)
{
    if (m.countGlass() < 2)
        return;
    const std::vector<Point3d> points = measureRig(calibrationOf(rig), glassPixels(m, (int)rig.cameras.size()), NONE).points;
    for (const auto& pair : m.neighbours)
    {
        const double length = norm(points[pair.second] - points[pair.first]);
        if (length == length)
            lengths.add(length - norm(m.objectPoints[pair.second] - m.objectPoints[pair.first]));
    }
}

//! The board where the direct image shows it: what the glass image should then be.
void addTransfer(const Ptr<RefractiveCamera>& camera, const Moment& m, int c, Pool& errors)
{
    Vec3d rvec, tvec;
    if (!m.isPair(c) || !refractiveSolvePnP(m.objectPoints, m.direct[c], copyWithWindow(camera, GlassWindow()), rvec, tvec))
        return;
    std::vector<Point2d> predicted;
    refractiveProjectPoints(m.objectPoints, rvec, tvec, camera, predicted);
    for (size_t i = 0; i < predicted.size(); i++)
    {
        const double error = norm(m.glass[c][i] - predicted[i]);
        if (error == error)
            errors.add(error);
    }
}

void addMisfit(const RigData& data, const Fit& trained, const std::vector<int>& test, Misfit& misfit)
{
    std::vector<Moment> moments;
    for (int i : test)
        moments.push_back(data.moments[i]);
    try
    {
        misfit.add(misfitOf(trained.rig, trained.covariance, trained.sigma, moments));
    }
    catch (const Failure&) {}       // no pose: the other numbers say it
}

double testRig(const RigData& data, const RigModel& rig, const std::vector<int>& test)
{
    PooledRms rms;
    for (size_t c = 0; c < rig.cameras.size(); c++)
        for (int i : test)
            rms.add(data.moments[i].objectPoints, data.moments[i].glass[c], rig.cameras[c]);
    return rms.value();
}

} // namespace

HeldOut holdOut(const RigData& data, const Fit& fit, int flags)
{
    std::vector<std::pair<double, int>> byRange;
    std::vector<int> always;
    splitMoments(data, fit, byRange, always);
    HeldOut result;
    if (byRange.size() < MIN_HELD_OUT)
        return result;
    result.folds = std::min(FOLDS, (int)byRange.size());
    PooledRms px, pinholePx;
    Pool transfer, lengths, pinholeLengths;
    for (int fold = 0; fold < result.folds; fold++)
    {
        std::vector<int> train = always, trainGlass, test;
        for (size_t k = 0; k < byRange.size(); k++)     // each fold over the whole range
            ((int)k % result.folds == fold ? test : trainGlass).push_back(byRange[k].second);
        train.insert(train.end(), trainGlass.begin(), trainGlass.end());
        const Fit trained = trainWindow(data, fit, flags, train);
        const RigModel window = trained.rig, pinhole = trainPinhole(data, fit, trainGlass);
        result.views += (int)test.size();
        if (window.cameras.empty())
            result.failed += (int)test.size();
        else
            addMisfit(data, trained, test, result.misfit);
        for (int i : test)
        {
            const Moment& m = data.moments[i];
            for (size_t c = 0; c < window.cameras.size(); c++)
            {
                px.add(m.objectPoints, m.glass[c], window.cameras[c]);
                addTransfer(window.cameras[c], m, (int)c, transfer);
            }
            for (size_t c = 0; c < pinhole.cameras.size(); c++)
                pinholePx.add(m.objectPoints, m.glass[c], pinhole.cameras[c]);
            if (!window.cameras.empty())
                addLengths(window, m, lengths);
            if (!pinhole.cameras.empty())
                addLengths(pinhole, m, pinholeLengths);
        }
    }
    result.px = px.value();
    result.pinholePx = pinholePx.value();
    result.transferPx = transfer.rms();
    result.lengthRms = lengths.rms();
    result.lengthMean = lengths.mean();
    result.pinholeLengthRms = pinholeLengths.rms();
    return result;
}

NearFar nearAgainstFar(const RigData& data, const Fit& fit, int flags)
{
    std::vector<std::pair<double, int>> byRange;
    std::vector<int> always, nearHalf, farHalf;
    splitMoments(data, fit, byRange, always);
    NearFar result;
    if (byRange.size() < 4)
        return result;
    const size_t half = byRange.size()/2;
    for (size_t k = 0; k < byRange.size(); k++)
        (k < half ? nearHalf : farHalf).push_back(byRange[k].second);
    result.done = true;
    result.nearRange[0] = byRange.front().first;
    result.nearRange[1] = byRange[half - 1].first;
    result.farRange[0] = byRange[half].first;
    result.farRange[1] = byRange.back().first;

    const auto window = [&](std::vector<int> train, const std::vector<int>& test) {
        train.insert(train.end(), always.begin(), always.end());
        return testRig(data, trainWindow(data, fit, flags, train).rig, test);
    };
    const auto pinhole = [&](const std::vector<int>& train, const std::vector<int>& test) {
        return testRig(data, trainPinhole(data, fit, train), test);
    };
    result.windowNearToFar = window(nearHalf, farHalf);
    result.windowFarToNear = window(farHalf, nearHalf);
    result.pinholeNearToFar = pinhole(nearHalf, farHalf);
    result.pinholeFarToNear = pinhole(farHalf, nearHalf);
    return result;
}

} // namespace tools
