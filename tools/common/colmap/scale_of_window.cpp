// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "colmap/scale_of_window.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/progress.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int IMAGES = 8, POINTS = 250, PAIRS = 10;     // of the trials
const double INFINITE = std::numeric_limits<double>::infinity();

//! The part of a survey that tries scales: some images, the points that most of them show.
struct Trials
{
    std::vector<int> images;                //!< of the model
    std::vector<int> points;
    std::vector<Vec3i> observations;
    std::vector<Point2d> pixels;
    std::vector<std::pair<int, int>> pairs; //!< of `points`, each in one pair: what holds the scale together
};

std::vector<int> order(const std::vector<int>& counts)
{
    std::vector<int> indices(counts.size());
    std::iota(indices.begin(), indices.end(), 0);
    std::stable_sort(indices.begin(), indices.end(), [&](int i, int j) { return counts[i] > counts[j]; });
    return indices;
}

Trials trialsOf(const Survey& survey)
{
    std::vector<int> ofImage(survey.model.images.size(), 0), shared(ofImage), ofPoint(survey.model.points.size(), 0);
    for (const Vec2i& source : survey.sources)
        ofImage[source[0]]++;
    const int first = order(ofImage)[0];
    std::vector<char> isInFirst(ofPoint.size(), 0);
    for (size_t i = 0; i < survey.sources.size(); i++)
        isInFirst[survey.observations[i][2]] |= survey.sources[i][0] == first;
    for (size_t i = 0; i < survey.sources.size(); i++)
        shared[survey.sources[i][0]] += isInFirst[survey.observations[i][2]];
    Trials trials;
    for (int image : order(shared))
        if ((int)trials.images.size() < IMAGES && shared[image] >= MIN_POINTS)
            trials.images.push_back(image);
    std::vector<int> indexOf(ofImage.size(), -1), pointIndex(ofPoint.size(), -1);
    for (size_t k = 0; k < trials.images.size(); k++)
        indexOf[trials.images[k]] = (int)k;
    for (size_t i = 0; i < survey.sources.size(); i++)
        ofPoint[survey.observations[i][2]] += indexOf[survey.sources[i][0]] >= 0;
    for (int point : order(ofPoint))
        if ((int)trials.points.size() < POINTS && ofPoint[point] >= 2)
        {
            pointIndex[point] = (int)trials.points.size();
            trials.points.push_back(point);
        }
    for (size_t i = 0; i < survey.sources.size(); i++)
    {
        const int view = indexOf[survey.sources[i][0]], point = pointIndex[survey.observations[i][2]];
        if (view < 0 || point < 0)
            continue;
        trials.observations.push_back({view, survey.observations[i][1], point});
        trials.pixels.push_back(survey.pixels[i]);
    }
    return trials;
}

/** Of those that most images show, each with the free one that is three quarters of the way to the farthest: a point that is wrong is far
from all others, and is in one pair of many. */
void findPairs(const Survey& survey, Trials& trials)
{
    const int some = (int)std::min<size_t>(trials.points.size(), 60);
    std::vector<char> isTaken(some, 0);
    for (int i = 0; i < some && (int)trials.pairs.size() < PAIRS; i++)
    {
        std::vector<std::pair<double, int>> free;
        for (int j = i + 1; j < some && !isTaken[i]; j++)
            if (!isTaken[j])
                free.push_back({norm(survey.model.points[trials.points[i]].X - survey.model.points[trials.points[j]].X), j});
        if (free.empty())
            continue;
        std::nth_element(free.begin(), free.begin() + 3*free.size()/4, free.end());
        const auto& partner = free[3*free.size()/4];
        if (!(partner.first > 0))
            continue;
        isTaken[i] = isTaken[partner.second] = 1;
        trials.pairs.push_back({i, partner.second});
    }
}

//! RMS of most: wrong observations have no say. Infinite where fewer have an error: a scene of which part cannot be seen fits no better.
double errorOfMost(std::vector<double> errors)
{
    const double MOST = 0.8;
    for (double& error : errors)
        error = std::isfinite(error) ? error : INFINITE;
    const size_t count = (size_t)(MOST*(double)errors.size());
    std::sort(errors.begin(), errors.end());
    const double squares = std::inner_product(errors.begin(), errors.begin() + (long)count, errors.begin(), 0.);
    return std::sqrt(squares/(double)count);
}

//! @return whether each view has one
bool findPoses(double factor, const Survey& survey, const RigModel& rig, const Trials& trials, const std::vector<Point3d>& points,
               std::vector<Mat>& rvecs, std::vector<Mat>& tvecs)
{
    std::vector<std::vector<Point3d>> objects(trials.images.size());
    std::vector<std::vector<Point2d>> pixels(trials.images.size());
    for (size_t i = 0; i < trials.observations.size(); i++)
    {
        objects[trials.observations[i][0]].push_back(points[trials.observations[i][2]]);
        pixels[trials.observations[i][0]].push_back(trials.pixels[i]);
    }
    for (size_t view = 0; view < trials.images.size(); view++)
    {
        const ColmapImage& image = survey.model.images[trials.images[view]];
        const int camera = survey.cameraOf[trials.images[view]];
        const RigidTransform pose = transformOf(image.cam_from_world);
        Vec3d rvec = rotationVector(pose.R), tvec = factor*pose.t;
        if (objects[view].size() < 4 || !refractiveSolvePnP(objects[view], pixels[view], rig.cameras[camera], rvec, tvec, true))
            return false;
        poseInCamera1(rig, camera, rvec, tvec);
        rvecs.push_back(Mat(rvec, true));
        tvecs.push_back(Mat(tvec, true));
    }
    return true;
}

//! px; infinite: no answer. All pairs together hold the scale, each by itself may be somewhat wrong.
double errorAt(double factor, const Survey& survey, const RigModel& rig, const Trials& trials)
{
    const double OF_PAIR = 0.01;
    std::vector<Point3d> points;
    for (int point : trials.points)
        points.push_back(Point3d(factor*survey.model.points[point].X));
    RigModel fitted = rig.clone();
    std::vector<Mat> rvecs, tvecs, Rs, Ts;
    if (!findPoses(factor, survey, rig, trials, points, rvecs, tvecs))
        return INFINITE;
    for (const RigidTransform& place : rig.extrinsics)
    {
        Rs.push_back(Mat(place.R, true));
        Ts.push_back(Mat(place.t, true));
    }
    std::vector<Vec4d> lengths;
    for (const auto& pair : trials.pairs)
    {
        const double length = norm(points[pair.first] - points[pair.second]);
        lengths.push_back({(double)pair.first, (double)pair.second, length, OF_PAIR*length});
    }
    BundleAdjustOptions options(GLASS_FIX_NORMAL | GLASS_ROBUST);
    options.criteria = TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 100, 1e-9);
    options.computePointDeviations = options.computeViewCovariances = false;
    try
    {
        refractiveBundleAdjust(trials.observations, trials.pixels, fitted.cameras, rig.windows, Rs, Ts, rvecs, tvecs, points, lengths,
                               options);
    }
    catch (const cv::Exception&)            // a scene that is too near
    {
        return INFINITE;
    }
    return errorOfMost(errorsOf(trials.observations, trials.pixels, fitted, vectorsOf(rvecs), vectorsOf(tvecs), points));
}

double medianDepth(const Survey& survey)
{
    std::vector<double> depths;
    for (size_t i = 0; i < survey.sources.size(); i += 1 + survey.sources.size()/10000)
        depths.push_back(transformOf(survey.imageOf((int)i).cam_from_world).apply(survey.model.points[survey.observations[i][2]].X)[2]);
    return median(depths);
}

//! Of the farthest glass from a camera.
double reachOf(const RigModel& rig)
{
    double reach = 0;
    for (const auto& camera : rig.cameras)
    {
        const GlassWindow window = camera->window();
        const double layers = std::accumulate(window.thickness.begin(), window.thickness.end(), 0.);
        reach = std::max(reach, window.distance + window.radius + layers);
    }
    return reach;
}

//! Where a parabola through three of them has its least, in the logarithm.
double leastOf(const std::vector<double>& factors, const std::vector<double>& errors, int best)
{
    const auto square = [&](int i) { return errors[i]*errors[i]; };
    const double curvature = square(best - 1) + square(best + 1) - 2*square(best);
    const double shift = curvature > 0 ? 0.5*(square(best - 1) - square(best + 1))/curvature : 0.;
    return factors[best]*std::pow(factors[best + 1]/factors[best], shift);
}

//! Throws Failure where the best is the first or last that has an answer: it may be farther on.
double bestOf(const std::vector<double>& factors, const std::vector<double>& errors, double depth)
{
    const int best = (int)(std::min_element(errors.begin(), errors.end()) - errors.begin()), last = (int)errors.size() - 1;
    if (!std::isfinite(errors[best]))
        throw Failure("nothing tells the scale: at no distance of the scene do rays through the window meet" + std::string(SCALE_ADVICE));
    if (best == 0 || !std::isfinite(errors[best - 1]))
        throw Failure(format("nothing tells the scale: rays through the window meet best with the scene at %.3g or nearer",
                             factors[best]*depth) + SCALE_ADVICE);
    if (best == last || !std::isfinite(errors[best + 1]))
        throw Failure(format("nothing tells the scale: rays through the window meet best with the scene at %.3g or farther",
                             factors[best]*depth) + SCALE_ADVICE);
    return leastOf(factors, errors, best);
}

} // namespace

ScaleOfWindow scaleOfWindow(const Survey& survey, const RigModel& rig, const std::string& folder, bool quiet)
{
    const double STEP = 1.4, NEAREST = 1.5, FARTHEST = 300.;        // of the window's reach
    const double reach = reachOf(rig), depth = medianDepth(survey);
    if (!(reach > 0))
        throw Failure("nothing tells the scale: there is no window that would" + std::string(SCALE_ADVICE));
    if (!(depth > 0))
        throw Failure("'" + folder + "': most of its points are behind its images: was it mirrored?");
    Trials trials = trialsOf(survey);
    findPairs(survey, trials);
    std::vector<double> factors, errors;
    for (double range = NEAREST*reach; range < FARTHEST*reach; range *= STEP)
        factors.push_back(range/depth);
    Progress progress("the scale by the window", (int)factors.size(), quiet);
    for (double factor : factors)
    {
        progress.at(format("scene at %.3g", factor*depth));
        errors.push_back(errorAt(factor, survey, rig, trials));
        progress.step();
    }
    ScaleOfWindow found;
    found.factor = bestOf(factors, errors, depth);
    const double UNKNOWN = 1.;      // of a length: it has little say, and more would be lost in the rounding of normal equations
    for (const auto& pair : trials.pairs)
    {
        const int a = trials.points[pair.first], b = trials.points[pair.second];
        const double length = found.factor*norm(survey.model.points[a].X - survey.model.points[b].X);
        found.asLengths.list.push_back({a, b, length, UNKNOWN*length, 0});
    }
    found.asLengths.objects = 1;
    return found;
}

} // namespace tools
