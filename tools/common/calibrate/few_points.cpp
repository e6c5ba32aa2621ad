// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/few_points.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"
#include <algorithm>

using namespace cv;

namespace tools {

namespace {

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
