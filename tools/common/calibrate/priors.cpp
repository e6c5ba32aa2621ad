// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/priors.hpp"
#include "calibrate/given_window.hpp"
#include "calibrate/parameter_columns.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! The farthest that a target's point is from the middle of its target.
double targetRadius(const RigData& data)
{
    double radius = 0.;
    for (const View& view : data.views)
    {
        Point3d middle;
        for (const Point3d& X : view.objectPoints)
            middle += X*(1./view.objectPoints.size());
        for (const Point3d& X : view.objectPoints)
            radius = std::max(radius, norm(X - middle));
    }
    return radius;
}

//! Mean position of the targets in camera 1, of those that it sees without its window; if there are none, through it.
Vec3d meanPosition(const RigData& data, const RigModel& rig)
{
    const Ptr<RefractiveCamera> bare = copyWithWindow(rig.cameras[0], GlassWindow());
    Vec3d sum;
    int count = 0;
    RigidTransform pose;
    for (bool glass : {false, true})
        for (const View& view : count ? std::vector<View>() : data.views)
            if (solveView(view, glass ? rig.cameras[0] : bare, (glass ? view.glass : view.direct)[0], pose))
            {
                sum += pose.t;
                count++;
            }
    return count ? sum*(1./count) : Vec3d();
}

} // namespace

KnownCamera knownOf(const RefractiveCamera& camera, const RigOptions& options, int c)
{
    const int lens = camera.lensParameters().rows;
    KnownCamera known{camera.lensParameters(), options.windowOf(c), Mat()};
    // Without a covariance the lens of a file is exact, unless the caller wants it free.
    const bool lensKnown = options.known[c] && !(options.knownCovariance[c].empty() && (options.flags & GLASS_FREE_INTRINSICS));
    const bool windowKnown = options.std.ofWindow() || options.areMarkersGiven();
    const Mat leftOut = lensKnown || options.leftOut.empty() ? Mat() : options.leftOut[c];
    if (!lensKnown && !windowKnown && leftOut.empty())
        return known;
    known.covariance = Mat::zeros(lens, lens, CV_64F);
    if (!leftOut.empty())
    {
        leftOut.copyTo(known.covariance);
        for (int i = 0; i < lens; i++)
            if (leftOut.at<double>(i, i) >= 0.)
                known.lens.at<double>(i) = 0.;
    }
    else if (!lensKnown)
        known.covariance.diag().setTo(NAN);         // nothing is known
    else if (!options.knownCovariance[c].empty())
        options.knownCovariance[c].copyTo(known.covariance);
    if (!windowKnown)
        return known;
    const ParameterColumns at = columnsOf(camera);
    Mat covariance = Mat::zeros(at.end, at.end, CV_64F);
    known.covariance.copyTo(covariance(Rect(0, 0, lens, lens)));
    putVariances(options.std, at, covariance);
    if (options.areMarkersGiven())
        options.placeOf(c).addTo(camera.window(), at, covariance);
    known.covariance = covariance;
    return known;
}

Mat targetCovarianceOf(const RigData& data, const RigModel& rig, const GivenStd& given)
{
    const bool moves = given.placement > 0. && data.countPairs() > 0;
    if (!moves && !(given.scale > 0.))
        return Mat();
    Mat covariance = Mat::zeros(TARGET_ERRORS, TARGET_ERRORS, CV_64F);
    covariance.at<double>(0, 0) = given.scale*given.scale;
    if (!moves)
        return covariance;
    // A rotation about c adds [c]x times its rotation vector to the translation.
    const Vec3d c = meanPosition(data, rig);
    const Matx33d cross(0, -c[2], c[1], c[2], 0, -c[0], -c[1], c[0], 0), unit = Matx33d::eye();
    const double rotation = std::pow(given.placement/targetRadius(data), 2), translation = given.placement*given.placement;
    Mat(rotation*unit).copyTo(covariance(Rect(1, 1, 3, 3)));
    Mat(rotation*cross).copyTo(covariance(Rect(1, 4, 3, 3)));
    Mat(rotation*cross.t()).copyTo(covariance(Rect(4, 1, 3, 3)));
    Mat(translation*unit + rotation*cross*cross.t()).copyTo(covariance(Rect(4, 4, 3, 3)));
    return covariance;
}

RigOptions withOpenDistance(const RigData& data, const RigModel& rig, RigOptions options)
{
    const double targets = norm(meanPosition(data, rig)), SOONER = 0.25;
    if (!(targets > 0.))
        return options;         // camera 1 saw nothing: told where the calibration fails
    options.window.distance = SOONER*targets;
    options.std.distance = Std(targets/std::sqrt(12.), "not given");
    return options;
}

} // namespace tools
