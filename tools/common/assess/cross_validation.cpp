// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/cross_validation.hpp"
#include "calibrate/fit.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "calibrate/refit.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"
#include "console/progress.hpp"
#include "math/dense.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/measurement.hpp"
#include "measure/view_observations.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int FOLDS = 5;
const size_t MIN_HELD_OUT = 3;      // views with a glass image, to hold any of them out

//! Range of the board's middle from camera 1.
double rangeOf(const RigData& data, const Fit& fit, size_t k)
{
    const std::vector<Point3d>& object = data.views[fit.views[k]].objectPoints;
    Point3d middle;
    for (const Point3d& X : object)
        middle += X*(1./object.size());
    return norm(transformOf(fit.rvecs[k], fit.tvecs[k]).apply(Vec3d(middle)));
}

//! Views with a glass image, nearest board first; the others, which are never held out.
void splitViews(const RigData& data, const Fit& fit, std::vector<std::pair<double, int>>& byRange, std::vector<int>& always)
{
    for (size_t k = 0; k < fit.views.size(); k++)
    {
        const int i = fit.views[k];
        if (data.views[i].hasGlass())
            byRange.push_back({rangeOf(data, fit, k), i});
        else
            always.push_back(i);
    }
    std::sort(byRange.begin(), byRange.end());
}

//! A fit of some views; no cameras if they do not determine it.
Fit trainWindow(const RigData& data, const Fit& fit, int flags, const std::vector<int>& train)
{
    try
    {
        return fitImages(data, fit.rig, train, flags | FROM_EARLIER_FIT);
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
        const Calibration pinhole = calibratePinholeRig(data, train, pinholeCoefficients(fit.rig, 0));
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

void addLengths(const RigModel& rig, const View& view, Pool& lengths)
{
    if (view.countGlass() < 2)
        return;
    const std::vector<Point3d> points = measureRig(calibrationOf(rig), glassPixels(view, (int)rig.cameras.size()), NONE).points;
    for (const auto& pair : view.neighbours)
    {
        const double length = norm(points[pair.second] - points[pair.first]);
        if (length == length)
            lengths.add(length - norm(view.objectPoints[pair.second] - view.objectPoints[pair.first]));
    }
}

//! The board where the direct image shows it: what the glass image should then be.
void addTransfer(const RigModel& rig, const View& view, int c, Pool& errors)
{
    const Ptr<RefractiveCamera> camera = rig.cameras[c];
    const std::vector<Point3d> object = pointsOfTarget(rig, view.objectPoints);
    Vec3d rvec, tvec;
    if (!view.isPair(c) || !refractiveSolvePnP(object, view.direct[c], copyWithWindow(camera, GlassWindow()), rvec, tvec))
        return;
    poseFromImage(rig, c, false, rvec, tvec);
    poseInImage(rig, c, true, rvec, tvec);
    std::vector<Point2d> predicted;
    refractiveProjectPoints(object, rvec, tvec, camera, predicted);
    for (size_t i = 0; i < predicted.size(); i++)
    {
        const double error = norm(view.glass[c][i] - predicted[i]);
        if (error == error)
            errors.add(error);
    }
}

void addTest(const RigData& data, const Fit& trained, const std::vector<int>& test, HeldOutTest& covarianceTest)
{
    std::vector<View> views;
    for (int i : test)
        views.push_back(data.views[i]);
    try
    {
        covarianceTest.add(testHeldOut(trained.rig, trained.withTargets, trained.sigma, views));
    }
    catch (const Failure&) {}       // no pose: the other numbers say it
}

double testRig(const RigData& data, const RigModel& rig, const std::vector<int>& test)
{
    PooledRms rms;
    for (size_t c = 0; c < rig.cameras.size(); c++)
        for (int i : test)
            rms.add(data.views[i].objectPoints, data.views[i].glass[c], rig.cameras[c]);
    return rms.value();
}

} // namespace

void HeldOutTest::add(const HeldOutTest& other)
{
    squares += other.squares;
    expectedSquares += other.expectedSquares;
    chiSquare += other.chiSquare;
    directions += other.directions;
}

double HeldOutTest::ratio() const
{
    return expectedSquares > 0. ? std::sqrt(squares/expectedSquares) : std::numeric_limits<double>::quiet_NaN();
}

double HeldOutTest::calibrationRatio() const
{
    return directions ? std::sqrt(chiSquare/directions) : std::numeric_limits<double>::quiet_NaN();
}

HeldOutTest testHeldOut(const RigModel& rig, const Mat& covariance, double sigma, const std::vector<View>& views)
{
    const CorrelationSpectrum spectrum(toEigen(covariance));
    const MatrixXd H = spectrum.root(spectrum.rank());      // H H^T = covariance
    MatrixXd AH(0, H.cols());
    VectorXd r(0);
    for (const View& view : views)
    {
        ViewObservations observed = observationsOf(rig, view);
        const ViewDerivatives derivatives = refinePose(rig, observed);
        const PoseNullSpace project(derivatives.byPose);
        const MatrixXd part = project(product(derivatives.byParameters, H));
        const Eigen::Index rows = r.size();
        AH.conservativeResize(rows + part.rows(), Eigen::NoChange);
        AH.bottomRows(part.rows()) = part;
        r.conservativeResize(rows + part.rows());
        r.tail(part.rows()) = project(observed.pixels - derivatives.predicted);
    }
    const SingularValues svd(AH);
    const VectorXd rAlong = transposeTimesVector(AH, r);        // U^T r of A H = U S V^T is S^-1 V^T (A H)^T r
    HeldOutTest test;
    test.squares = r.squaredNorm();
    test.expectedSquares = sigma*sigma*(double)r.size() + svd.values.squaredNorm();
    for (int i = 0; i < svd.values.size() && svd.values[i] > sigma; i++)
    {
        const double variance = sigma*sigma + std::pow(svd.values[i], 2);
        test.chiSquare += std::pow(svd.V.col(i).dot(rAlong)/svd.values[i], 2)/variance;
        test.directions++;
    }
    return test;
}

HeldOut holdOut(const RigData& data, const Fit& fit, int flags)
{
    std::vector<std::pair<double, int>> byRange;
    std::vector<int> always;
    splitViews(data, fit, byRange, always);
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
            addTest(data, trained, test, result.covarianceTest);
        for (int i : test)
        {
            const View& view = data.views[i];
            for (size_t c = 0; c < window.cameras.size(); c++)
            {
                px.add(view.objectPoints, view.glass[c], window.cameras[c]);
                addTransfer(window, view, (int)c, transfer);
            }
            for (size_t c = 0; c < pinhole.cameras.size(); c++)
                pinholePx.add(view.objectPoints, view.glass[c], pinhole.cameras[c]);
            if (!window.cameras.empty())
                addLengths(window, view, lengths);
            if (!pinhole.cameras.empty())
                addLengths(pinhole, view, pinholeLengths);
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
    splitViews(data, fit, byRange, always);
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

std::vector<Influence> leaveOneOut(const RigData& data, const Fit& fit, int flags, bool quiet)
{
    std::vector<Influence> result;
    for (int i : fit.views)
        if (data.views[i].hasGlass())
            result.push_back({i, std::vector<double>(data.cameraCount, NONE)});
    if (result.size() < 3)
        return {};
    Progress progress("leaving out one view at a time", (int)result.size(), quiet);
    for (Influence& influence : result)
    {
        std::vector<int> others = fit.views;
        others.erase(std::find(others.begin(), others.end(), influence.view));
        try
        {
            const Fit without = fitImages(data, fit.rig, others, flags | FROM_EARLIER_FIT);
            for (int c = 0; c < data.cameraCount; c++)
                influence.change[c] = placeChange(fit.rig.cameras[c]->window(), without.rig.cameras[c]->window());
        }
        catch (const cv::Exception&) {}     // the others alone do not determine the window: stays NaN
        progress.step();
    }
    return result;
}

} // namespace tools
