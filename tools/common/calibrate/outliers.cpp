// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/outliers.hpp"
#include "calibrate/fit.hpp"
#include "calibrate/refit.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"
#include <algorithm>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const char* reasonOf(uchar status)
{
    switch (status)
    {
    case GLASS_IMAGE_MOVED: return "its board is not where the other images of the moment have it";
    case GLASS_IMAGE_UNUSABLE: return "hardly any of its points fit one pose of the board";
    default: return "points that do not fit: hidden, smeared or wrongly detected";
    }
}

//! Takes the marked points out; true if there were any.
bool clean(std::vector<Point2d>& pixels, uchar status, const Mat& inliers, Rejected& rejected)
{
    rejected.image = status == GLASS_IMAGE_MOVED || status == GLASS_IMAGE_UNUSABLE;
    rejected.why = reasonOf(status);
    rejected.points = 0;
    for (size_t i = 0; i < pixels.size(); i++)
    {
        if (!seen(pixels[i]) || (!rejected.image && inliers.at<uchar>((int)i)))
            continue;
        pixels[i] = Point2d(NAN, NAN);
        rejected.points++;
    }
    if (rejected.image)
        pixels.clear();
    return rejected.points > 0;
}

//! Images of pairs that a robust fit has no use for, and how many pairs there are.
bool losesPairs(const RigData& data, const Fit& fit)
{
    const double MOST = 1./3;
    int pairs = 0, lost = 0;
    for (int i = 0; i < (int)data.views.size(); i++)
        for (int c = 0; c < data.cameraCount; c++)
        {
            if (!data.views[i].isPair(c))
                continue;
            pairs++;
            bool whole = true;
            for (int column : {2*c, 2*c + 1})
                whole = whole && fit.imageStatus.at<uchar>(i, column) == GLASS_IMAGE_USED;
            lost += !whole;
        }
    return lost > MOST*pairs;
}

/** The robust fit of everything. Where it would lose more than a third of the pairs, a wrong given value may be why: the pairs
are then evidence of it. The fit with that value free knows which points are wrong. */
Fit robustFit(const RigData& data, const RigModel& start, int flags, int maxIterations)
{
    const Fit fit = fitImages(data, start, allViews(data), flags | GLASS_ROBUST, maxIterations);
    if (!losesPairs(data, fit))
        return fit;
    for (int value : {GLASS_FREE_THICKNESS, GLASS_FREE_INDEX, GLASS_FREE_OUTER_INDEX})
        try
        {
            const Fit freed = fitImages(data, start, allViews(data), flags | value | GLASS_ROBUST, maxIterations);
            if (!losesPairs(data, freed))
                return freed;
        }
        catch (const cv::Exception&) {}     // there is no such value, or it is not determined
    return fit;
}

bool fromImages(const std::vector<LensSource>& sources)
{
    return std::any_of(sources.begin(), sources.end(), [](const LensSource& s) { return s.kind != LensSource::FROM_FILE; });
}

bool areSame(const std::vector<Rejected>& a, const std::vector<Rejected>& b)
{
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Rejected& x, const Rejected& y)
           { return x.view == y.view && x.camera == y.camera && x.glass == y.glass && x.points == y.points; });
}

const double ON_LINE = 1e-6;            // of the distance along it

int countBeside(const std::vector<Point3d>& points, const Point3d& from, const Point3d& to)
{
    const Vec3d along = Vec3d(to - from);
    return (int)std::count_if(points.begin(), points.end(), [&](const Point3d& p) {
        const Vec3d there(p - from);
        return norm(along.cross(there)) > ON_LINE*norm(along)*std::max(norm(along), norm(there));
    });
}

/** All of them, or all but one: that is no more than three points tell. If so, two of any three points are on the line. */
bool areOnLine(const std::vector<Point3d>& points)
{
    for (int k = 0; k < 3; k++)
        if (countBeside(points, points[k], points[(k + 1) % 3]) < 2)
            return true;
    return false;
}

//! Why the view has no pose; empty if it may have one.
std::string faultOf(const DetectedImage& image, const Target* target)
{
    const std::vector<Point3d>& object = image.objectPoints.empty() ? target->objectPoints() : image.objectPoints;
    std::vector<Point3d> points;
    for (size_t i = 0; i < image.points.size(); i++)
        if (seen(image.points[i]))
            points.push_back(object[i]);
    const std::string pose = format("the target's pose needs %d that are not on a line", MIN_POSE_POINTS);
    if ((int)points.size() < MIN_POSE_POINTS)
        return format("%zu point%s, but ", points.size(), points.size() == 1 ? "" : "s") + pose;
    if (areOnLine(points))
        return format("%zu points, of which all or all but one are on a line, but ", points.size()) + pose;
    return "";
}

//! What is left; of what is taken out, why.
DetectedImages leaveOut(const Target* target, int camera, bool glass, const DetectedImages& set, std::vector<Rejected>& rejected)
{
    DetectedImages rest = set;
    rest.images.clear();
    std::string first;
    for (const DetectedImage& image : set.images)
    {
        const std::string fault = faultOf(image, target);
        if (fault.empty())
            rest.images.push_back(image);
        else if (image.seenCount())
            rejected.push_back({image.stem, camera, glass, image.seenCount(), true, fault});
        if (first.empty())
            first = fault;
    }
    if (rest.images.empty() && !set.images.empty())
        throw Failure(format("camera %d, --%s%s='%s': view '%s' has ", camera + 1, glass ? "glass" : "direct",
                             cameraSuffix(camera).c_str(), set.images[0].path.c_str(), set.images[0].stem.c_str()) + first
                      + (set.images.size() == 1 ? "" : ", and the other views have no pose either")
                      + ". Give more points of a view, or leave the option out");
    return rest;
}

} // namespace

std::string Rejected::sentence() const
{
    return format("'%s' (camera %d, %s): %s: %s", view.c_str(), camera + 1, glass ? "through the window" : "direct",
                  image ? "the whole image" : format("%d point%s", points, points == 1 ? "" : "s").c_str(), why.c_str());
}

Outliers rejectOutliers(RigData& data, const RigModel& start, int flags, int maxIterations)
{
    Fit fit;
    try
    {
        fit = robustFit(data, start, flags, maxIterations);
    }
    catch (const cv::Exception& e)
    {
        return {{}, e.err};
    }
    Outliers outliers;
    for (int i = 0; i < (int)data.views.size(); i++)
        for (int c = 0; c < data.cameraCount; c++)
            for (bool glass : {true, false})
            {
                View& view = data.views[i];
                const int column = 2*c + glass;
                Rejected rejected{view.stem, c, glass, 0, false, ""};
                if (clean(glass ? view.glass[c] : view.direct[c], fit.imageStatus.at<uchar>(i, column),
                          fit.inliers[fit.imageStatus.cols*i + column], rejected))
                    outliers.rejected.push_back(rejected);
            }
    return outliers;
}

//! Points that are left out because their whole image is.
static int pointsOfRejectedImages(const Outliers& outliers)
{
    int points = 0;
    for (const Rejected& rejected : outliers.rejected)
        points += rejected.image ? rejected.points : 0;
    return points;
}

Outliers rejectOutliers(RigData& data, const RigModel& start, int flags, const std::vector<LensSource>& lensSources, int maxIterations)
{
    RigData freed = data;
    const Outliers byHeld = rejectOutliers(data, start, flags, maxIterations);
    const bool mayBeLens = fromImages(lensSources) && !(flags & GLASS_FREE_INTRINSICS);
    if (!mayBeLens || (byHeld.fault.empty() && pointsOfRejectedImages(byHeld) == 0))
        return byHeld;
    const Outliers byFreed = rejectOutliers(freed, start, flags | GLASS_FREE_INTRINSICS, maxIterations);
    if (byHeld.fault.empty() && (!byFreed.fault.empty() || pointsOfRejectedImages(byFreed) >= pointsOfRejectedImages(byHeld)))
        return byHeld;
    data = freed;
    return byFreed;
}

//! Few points, and no whole image.
static bool areSingle(const Outliers& outliers, const RigData& data)
{
    const double MOST = 0.01;           // of all
    int all = 0, rejected = 0;
    for (const View& view : data.views)
        for (int c = 0; c < data.cameraCount; c++)
            all += (int)std::count_if(view.glass[c].begin(), view.glass[c].end(), seen);
    for (const Rejected& r : outliers.rejected)
        rejected += r.points;
    return outliers.fault.empty() && pointsOfRejectedImages(outliers) == 0 && rejected < MOST*all;
}

Outliers startWithoutOutliers(RigData& data, const RigOptions& options, RigModel& start, std::vector<LensSource>& lensSources,
                              int maxIterations, std::optional<RigModel>& only)
{
    if (only)
    {
        RigData rest = data;
        start = startModel(data, options, lensSources, &*only);
        const Outliers outliers = rejectOutliers(rest, start, options.flags | FROM_EARLIER_FIT, maxIterations);
        if (areSingle(outliers, data))
        {
            data = rest;
            return outliers;
        }
        only.reset();
    }
    return startWithoutOutliers(data, options, start, lensSources, maxIterations);
}

Outliers startWithoutOutliers(RigData& data, const RigOptions& options, RigModel& start,
                              std::vector<LensSource>& lensSources, int maxIterations)
{
    const int MOST_ROUNDS = 5;
    const RigData all = data;
    start = startModel(all, options, lensSources);
    Outliers outliers;
    bool settled = false;
    for (int round = 0; round < MOST_ROUNDS && !settled; round++)
    {
        RigData rest = all;
        const Outliers found = rejectOutliers(rest, start, options.flags, lensSources, maxIterations);
        if (!found.fault.empty() && round > 0)
            break;
        settled = areSame(found.rejected, outliers.rejected);
        outliers = found;
        data = rest;
        if (!settled)
            start = startModel(data, options, lensSources);
    }
    return outliers;
}

std::vector<Rejected> leaveOutFewPoints(const Target* target, RigImages& sets)
{
    std::vector<Rejected> rejected;
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (bool glass : {true, false})
        {
            DetectedImages& set = (glass ? sets.glass : sets.direct)[c];
            set = leaveOut(target, c, glass, set, rejected);
        }
    return rejected;
}

} // namespace tools
