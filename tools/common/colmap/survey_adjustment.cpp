// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "colmap/survey_adjustment.hpp"
#include "colmap/scale_of_window.hpp"
#include "console/failure.hpp"
#include "console/progress.hpp"
#include "math/rotation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();

std::vector<Mat> arraysOf(const std::vector<Vec3d>& vectors)
{
    std::vector<Mat> arrays;
    for (const Vec3d& v : vectors)
        arrays.push_back(Mat(v, true));
    return arrays;
}

//! What is known of positions holds near these poses; adjusted again from there it holds where they are.
void adjust(const Survey& survey, const BundleStart& bundle, const SurveyStart& start, bool robust, double memory,
            SurveyAdjustment& result, std::vector<Point3d>& points, Mat& deviations)
{
    Fit& fit = result.bundle.fit;
    std::vector<Mat> Rs, Ts;
    for (const RigidTransform& place : fit.rig.extrinsics)
    {
        Rs.push_back(Mat(place.R, true));
        Ts.push_back(Mat(place.t, true));
    }
    BundleAdjustOptions options(bundle.flags | (robust ? GLASS_ROBUST : 0));
    options.poseCovariances = covariancesOfPoses(start, result.rvecs, result.tvecs);
    if (!options.poseCovariances.empty())
        options.flags |= GLASS_USE_POSES;
    options.rigCovariance = bundle.covariance;
    options.lengthScaleStd = start.lengths.commonStd();
    options.covarianceMemory = 1e9*memory;
    std::vector<Mat> rvecs = arraysOf(result.rvecs), tvecs = arraysOf(result.tvecs);
    BundleAdjustResult found;
    const auto run = [&] {
        found = refractiveBundleAdjust(survey.observations, survey.pixels, fit.rig.cameras, fit.rig.windows, Rs, Ts, rvecs, tvecs, points,
                                       start.lengths.rows(), options);
    };
    adjustOrExplain([&] {
        try
        {
            run();
        }
        catch (const CalibrationError& e)
        {
            if (e.view < 0)
                throw;
            if (start.isScaleOfWindow && e.cause == CalibrationError::POSE_UNDETERMINED)
                throw Failure(std::string("nothing tells the scale: refraction at the window is too little in these images")
                              + SCALE_ADVICE);
            throw Failure("view '" + survey.views[e.view] + "' is to blame: " + (e.reason.empty() ? e.err : e.reason)
                          + "; leave it out of the model, or its wrong points");
        }
    });
    setEstimate(found, fit);
    result.viewCovariances = found.viewCovariances;
    result.used = found.inliers[0];
    deviations = found.pointDeviations;
    for (size_t c = 1; c < Rs.size(); c++)
        fit.rig.extrinsics[c] = {Rs[c], Ts[c]};
    result.rvecs = vectorsOf(rvecs);
    result.tvecs = vectorsOf(tvecs);
}

//! What has no answer may have one from where it started.
void restartLost(const SurveyStart& start, std::vector<Point3d>& points, SurveyAdjustment& result)
{
    for (size_t i = 0; i < points.size(); i++)
        if (!std::isfinite(points[i].x))
            points[i] = start.points[i];
    for (size_t view = 0; view < result.rvecs.size(); view++)
        if (!result.hasPose((int)view))
        {
            result.rvecs[view] = start.rvecs[view];
            result.tvecs[view] = start.tvecs[view];
        }
}

//! @return the squares of all errors that are used
double setErrors(const Survey& survey, SurveyAdjustment& result)
{
    const RigModel& rig = result.bundle.fit.rig;
    std::vector<double> squares(rig.cameras.size(), 0.);
    std::vector<int> counts(rig.cameras.size(), 0);
    result.errors = errorsOf(survey.observations, survey.pixels, rig, result.rvecs, result.tvecs, result.bundle.points);
    for (size_t i = 0; i < result.errors.size(); i++)
        if (result.used[i])
        {
            squares[survey.observations[i][1]] += result.errors[i]*result.errors[i];
            counts[survey.observations[i][1]]++;
        }
    double all = 0.;
    for (size_t c = 0; c < squares.size(); c++)
    {
        result.bundle.rmsOfCamera.push_back(counts[c] ? std::sqrt(squares[c]/counts[c]) : -1.);
        all += squares[c];
    }
    return all;
}

//! Of a view most of whose observations are wrong the rest agree by chance: it has no pose.
void loseDoubtfulViews(const Survey& survey, SurveyAdjustment& result)
{
    std::vector<int> seen(result.rvecs.size(), 0), kept(result.rvecs.size(), 0);
    for (size_t i = 0; i < survey.observations.size(); i++)
    {
        seen[survey.observations[i][0]]++;
        kept[survey.observations[i][0]] += result.used[i];
    }
    const auto isDoubtful = [&](int view) { return 2*kept[view] < seen[view]; };
    for (size_t i = 0; i < survey.observations.size(); i++)
        result.used[i] = result.used[i] && !isDoubtful(survey.observations[i][0]);
    for (int view = 0; view < (int)result.rvecs.size(); view++)
        if (isDoubtful(view))
            result.rvecs[view] = result.tvecs[view] = Vec3d::all(NaN);
}

//! A point whose +- is not finite has no answer, and its observations no use.
void setPoints(const Survey& survey, const std::vector<Point3d>& points, const Mat& deviations, SurveyAdjustment& result)
{
    std::vector<int> seen(points.size(), 0);
    std::vector<char> isFound(points.size(), 0);
    for (size_t i = 0; i < points.size(); i++)
    {
        const Vec3d s(deviations.ptr<double>((int)i));
        isFound[i] = std::isfinite(points[i].x + s[0] + s[1] + s[2]);
    }
    result.images.assign(points.size(), 0);
    for (size_t i = 0; i < survey.observations.size(); i++)
    {
        const int point = survey.observations[i][2];
        seen[point]++;
        result.used[i] = result.used[i] && isFound[point];
        result.images[point] += result.used[i];
    }
    for (size_t i = 0; i < points.size(); i++)
    {
        const bool found = isFound[i] != 0;
        const Vec3d s(deviations.ptr<double>((int)i));
        result.bundle.points.push_back(found ? points[i] : Point3d(NaN, NaN, NaN));
        result.bundle.sigma.push_back(found ? s : Vec3d::all(NaN));
        result.bundle.status.push_back(found ? (uchar)REFRACT_OK : seen[i] < 2 ? (uchar)REFRACT_NOT_FINITE : INCONSISTENT);
        result.bundle.seenPixels += seen[i] > 1 ? seen[i] : 0;
        result.bundle.usedPixels += result.images[i];
    }
}

//! Of the directions from where the cameras were.
void setAngles(const Survey& survey, SurveyAdjustment& result)
{
    const size_t count = result.bundle.points.size();
    std::vector<std::vector<Vec3d>> directions(count);
    std::vector<double> nearest(count, std::numeric_limits<double>::infinity());
    for (size_t i = 0; i < survey.observations.size(); i++)
    {
        const Vec3i& o = survey.observations[i];
        if (!result.used[i])
            continue;
        const RigidTransform pose = result.bundle.fit.rig.extrinsics[o[1]]*result.poseOf(o[0]);
        const Vec3d direction = Vec3d(result.bundle.points[o[2]]) - pose.inverse(Vec3d());
        nearest[o[2]] = std::min(nearest[o[2]], norm(direction));
        directions[o[2]].push_back(direction/norm(direction));
    }
    result.angles.assign(count, NaN);
    for (size_t i = 0; i < count; i++)
    {
        double least = 1.;
        for (size_t a = 0; a < directions[i].size(); a++)
            for (size_t b = 0; b < a; b++)
                least = std::min(least, directions[i][a].dot(directions[i][b]));
        if (std::isfinite(result.bundle.points[i].x))
            result.angles[i] = std::acos(std::min(1., least))*180./CV_PI;
        result.isVague.push_back(norm(result.bundle.sigma[i]) > 0.1*nearest[i]);
        result.largeErrors += result.isVague[i];
    }
}

//! Of distances from the first view, which is the frame.
double scaleStdByViews(const SurveyAdjustment& result)
{
    int frame = 0;
    while (frame < (int)result.rvecs.size() && !result.hasPose(frame))
        frame++;
    double least = std::numeric_limits<double>::infinity();
    for (int view = frame + 1; view < (int)result.rvecs.size(); view++)
    {
        if (!result.hasPose(view))
            continue;
        const Vec3d base = result.centreOf(view) - result.centreOf(frame);
        const Matx33d covariance = result.centreCovariance(view) + result.centreCovariance(frame);
        const double length = norm(base), variance = base.dot(covariance*base)/(length*length);
        if (length > 0 && std::isfinite(variance))
            least = std::min(least, std::sqrt(variance)/length);
    }
    return least;
}

//! No view is the frame then, and what is common to all places counts nothing: what positions tell by themselves, or better.
double scaleStdByPositions(const SurveyStart& start, const SurveyAdjustment& result)
{
    Vec3d mean;
    double weights = 0., information = 0.;
    const auto sum = [&](const std::function<void(const KnownPosition&, double)>& add) {
        for (const auto& position : start.positions)
            if (result.hasPose(position.first))
                add(position.second, 1./(position.second.std*position.second.std));
    };
    sum([&](const KnownPosition& position, double weight) {
        mean += weight*position.center;
        weights += weight;
    });
    mean *= 1./weights;
    sum([&](const KnownPosition& position, double weight) {
        const Vec3d off = position.center - mean;
        information += weight*off.dot(off);
    });
    return 1./std::sqrt(information);
}

void setPlaces(const SurveyStart& start, SurveyAdjustment& result)
{
    for (const auto& position : start.positions)
        if (result.hasPose(position.first))
        {
            const Vec3d place = result.centreOf(position.first), off = place - position.second.center;
            result.bundle.places[position.first] = place;
            result.bundle.squaredKnown += off.dot(off)/(position.second.std*position.second.std);
        }
}

} // namespace

Matx33d SurveyAdjustment::centreCovariance(int view) const
{
    // centre = -R^T t
    const Rotation rotation(rvecs[view].val);
    Matx<double, 3, 6> J;
    for (int k = 0; k < 3; k++)
    {
        const Vec3d byTurn = -(rotation.dR[k].t()*tvecs[view]);
        for (int r = 0; r < 3; r++)
        {
            J(r, k) = byTurn[r];
            J(r, 3 + k) = -rotation.R(k, r);
        }
    }
    return J*Matx66d(viewCovariances[view].ptr<double>())*J.t();
}

SurveyAdjustment adjustSurvey(const Survey& survey, const BundleStart& bundle, const SurveyStart& start, bool robust, double memory,
                              bool quiet)
{
    SurveyAdjustment result;
    result.bundle.fit.rig = bundle.rig.clone();
    result.rvecs = start.rvecs;
    result.tvecs = start.tvecs;
    std::vector<Point3d> points = start.points;
    Mat deviations;
    const int rounds = start.positions.empty() ? 1 : 2;
    Progress progress("adjusting", rounds, quiet);
    for (int round = 0; round < rounds; round++)
    {
        progress.at(format("%zu views, %zu points, %zu observations", survey.views.size(), points.size(), survey.observations.size()));
        result.bundle.fit.rig = bundle.rig.clone();     // what is known of it is known of these values
        adjust(survey, bundle, start, robust, memory, result, points, deviations);
        if (round + 1 < rounds)
            restartLost(start, points, result);
        progress.step();
    }
    for (size_t view = 0; view < result.rvecs.size(); view++)
        result.arePointsAlone |= result.hasPose((int)view) && std::isnan(result.viewCovariances[view].at<double>(0, 0));
    loseDoubtfulViews(survey, result);
    setPoints(survey, points, deviations, result);
    result.bundle.squaredPixels = setErrors(survey, result);
    setAngles(survey, result);
    result.scaleStd = start.positions.empty() ? scaleStdByViews(result) : scaleStdByPositions(start, result);
    result.bundle.squaredKnown = squaredKnown(bundle, start.lengths, result.bundle);
    setPlaces(start, result);
    result.bundle.used = {result.used};
    return result;
}

} // namespace tools
