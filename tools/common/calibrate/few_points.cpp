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
std::string faultOf(const DetectedView& view, const Target* target)
{
    const std::vector<Point3d>& object = view.objectPoints.empty() ? target->objectPoints() : view.objectPoints;
    std::vector<Point3d> points;
    for (size_t i = 0; i < view.points.size(); i++)
        if (seen(view.points[i]))
            points.push_back(object[i]);
    const std::string pose = format("the target's pose needs %d that are not on a line", POINTS_OF_POSE);
    if ((int)points.size() < POINTS_OF_POSE)
        return format("%zu point%s, but ", points.size(), points.size() == 1 ? "" : "s") + pose;
    if (areOnLine(points))
        return format("%zu points, of which all or all but one are on a line, but ", points.size()) + pose;
    return "";
}

//! What is left; of what is taken out, why.
ViewSet leaveOut(const Target* target, int camera, bool glass, const ViewSet& set, std::vector<Dropped>& dropped)
{
    ViewSet rest = set;
    rest.views.clear();
    std::string first;
    for (const DetectedView& view : set.views)
    {
        const std::string fault = faultOf(view, target);
        if (fault.empty())
            rest.views.push_back(view);
        else if (view.seenCount())
            dropped.push_back({view.stem, camera, glass, view.seenCount(), true, fault});
        if (first.empty())
            first = fault;
    }
    if (rest.views.empty() && !set.views.empty())
        throw Failure(format("camera %d, --%s%s='%s': view '%s' has ", camera + 1, glass ? "glass" : "direct",
                             cameraSuffix(camera).c_str(), set.views[0].path.c_str(), set.views[0].stem.c_str()) + first
                      + (set.views.size() == 1 ? "" : ", and so it is with the other views")
                      + ". Give more points of a view, or leave the option out");
    return rest;
}

} // namespace

std::vector<Dropped> leaveOutFewPoints(const Target* target, RigViewSets& sets)
{
    std::vector<Dropped> dropped;
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (bool glass : {true, false})
        {
            ViewSet& set = (glass ? sets.glass : sets.direct)[c];
            set = leaveOut(target, c, glass, set, dropped);
        }
    return dropped;
}

} // namespace tools
