// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "colmap/scale_of_window.hpp"
#include "console/failure.hpp"
#include "console/progress.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int IMAGES = 8, POINTS = 250;         // of the trials
const double INFINITE = std::numeric_limits<double>::infinity();

//! The part of a survey that tries scales: some images, the points that most of them show.
struct Trials
{
    std::vector<int> images;                //!< of the model
    std::vector<int> points;
    std::vector<Vec3i> observations;
    std::vector<Point2d> pixels;
    int a = 0, b = 0;                       //!< of `points`, far from each other
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

void findFarPoints(const Survey& survey, Trials& trials)
{
    const size_t some = std::min<size_t>(trials.points.size(), 60);      // those that most images show
    double farthest = 0;
    for (size_t i = 0; i < some; i++)
        for (size_t j = 0; j < i; j++)
        {
            const double distance = norm(survey.model.points[trials.points[i]].X - survey.model.points[trials.points[j]].X);
            if (distance > farthest)
            {
                farthest = distance;
                trials.a = (int)i;
                trials.b = (int)j;
            }
        }
}

//! px; infinite: no answer.
double errorAt(double factor, const Survey& survey, const RigModel& rig, const Trials& trials)
{
    std::vector<Point3d> points;
    for (int point : trials.points)
        points.push_back(Point3d(factor*survey.model.points[point].X));
    std::vector<Mat> rvecs, tvecs, Rs, Ts, viewCovariances;
    for (size_t c = 0; c < rig.cameras.size(); c++)
    {
        Rs.push_back(Mat(rig.extrinsics[c].R, true));
        Ts.push_back(Mat(rig.extrinsics[c].T, true));
    }
    for (size_t view = 0; view < trials.images.size(); view++)
    {
        const ColmapImage& image = survey.model.images[trials.images[view]];
        const int camera = survey.cameraOf[trials.images[view]];
        RigidTransform pose = transformOf(image.cam_from_world);
        std::vector<Point3d> objects;
        std::vector<Point2d> pixels;
        for (size_t i = 0; i < trials.observations.size(); i++)
            if (trials.observations[i][0] == (int)view)
            {
                objects.push_back(points[trials.observations[i][2]]);
                pixels.push_back(trials.pixels[i]);
            }
        Vec3d rvec = rotationVector(pose.R), tvec = factor*pose.T;
        if (objects.size() < 4 || !refractiveSolvePnP(objects, pixels, rig.cameras[camera], rvec, tvec, true))
            return INFINITE;
        poseInCamera1(rig, camera, rvec, tvec);
        rvecs.push_back(Mat(rvec, true));
        tvecs.push_back(Mat(tvec, true));
    }
    const double length = norm(points[trials.a] - points[trials.b]);
    const std::vector<Vec4d> lengths = {{(double)trials.a, (double)trials.b, length, 1e-4*length}};
    std::vector<Ptr<RefractiveCamera>> cameras = rig.clone().cameras;
    Mat deviations, covariance, pointDeviations, errors, inliers;
    try
    {
        return refractiveBundleAdjust(trials.observations, trials.pixels, cameras, rig.windows, Rs, Ts, rvecs, tvecs, points, lengths,
                                      deviations, covariance, noArray(), pointDeviations, errors, inliers, GLASS_FIX_NORMAL, noArray(),
                                      TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 100, 1e-9));
    }
    catch (const cv::Exception&)            // a scene that is too near
    {
        return INFINITE;
    }
}

double medianDepth(const Survey& survey)
{
    std::vector<double> depths;
    for (size_t i = 0; i < survey.sources.size(); i += 1 + survey.sources.size()/10000)
        depths.push_back((transformOf(survey.imageOf((int)i).cam_from_world)*survey.model.points[survey.observations[i][2]].X)[2]);
    std::nth_element(depths.begin(), depths.begin() + depths.size()/2, depths.end());
    return depths[depths.size()/2];
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
    if (best == 0 || best + 1 == (int)errors.size() || !std::isfinite(errors[best - 1]) || !std::isfinite(errors[best + 1]))
        return factors[best];
    const auto square = [&](int i) { return errors[i]*errors[i]; };
    const double curvature = square(best - 1) + square(best + 1) - 2*square(best);
    const double shift = curvature > 0 ? 0.5*(square(best - 1) - square(best + 1))/curvature : 0.;
    return factors[best]*std::pow(factors[best + 1]/factors[best], shift);
}

} // namespace

ScaleOfWindow scaleOfWindow(const Survey& survey, const RigModel& rig, const std::string& folder, bool quiet)
{
    const double STEP = 1.4, NEAREST = 1.5, FARTHEST = 300.;        // of the window's reach
    const char ADVICE[] = "; give --lengths or --positions";
    const double reach = reachOf(rig), depth = medianDepth(survey);
    if (!(reach > 0))
        throw Failure("nothing tells the scale: there is no window that would" + std::string(ADVICE));
    if (!(depth > 0))
        throw Failure("'" + folder + "': most of its points are behind its images: was it mirrored?");
    Trials trials = trialsOf(survey);
    findFarPoints(survey, trials);
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
    const int best = (int)(std::min_element(errors.begin(), errors.end()) - errors.begin());
    if (!std::isfinite(errors[best]))
        throw Failure("nothing tells the scale: at no distance of the scene do rays through the window meet" + std::string(ADVICE));
    ScaleOfWindow found;
    found.factor = leastOf(factors, errors, best);
    const double UNKNOWN = 0.3;             // of the length
    const int a = trials.points[trials.a], b = trials.points[trials.b];
    const double length = found.factor*norm(survey.model.points[a].X - survey.model.points[b].X);
    found.asLength.list.push_back({a, b, length, UNKNOWN*length, 0});
    found.asLength.objects = 1;
    return found;
}

} // namespace tools
