// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/seen_points.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"

#include <cmath>

namespace tools {

using cv::Point2d;
using cv::Point3d;
using cv::Ptr;
using cv::Vec3d;
using cv::refract::RefractiveCamera;

//! Nearly all pixels see z beyond the window; not all of a wide lens do, which looks along a tilted one.
static bool isBeyondWindow(const Ptr<RefractiveCamera>& camera, const std::vector<Point2d>& pixels, double z)
{
    const WindowFace last = WindowFace::last(camera->window());
    std::vector<Vec3d> origins, directions;
    cv::refract::refractiveUnprojectPoints(pixels, origins, directions, camera);
    size_t forward = 0, within = 0;
    for (size_t i = 0; i < pixels.size(); i++)
        if (directions[i][2] > 0)
        {
            const Vec3d X = origins[i] + (z - origins[i][2])/directions[i][2]*directions[i];
            forward++;
            within += last.isBefore(X);
        }
    return 10*within <= forward;
}

SeenPoints seenPoints(const Ptr<RefractiveCamera>& camera, const cv::Vec2d& range, int columns, int rows, int depths)
{
    const cv::Size size = camera->imageSize();
    std::vector<Point2d> grid;
    for (int i = 0; i < columns*rows; i++)
        grid.emplace_back((i % columns)*(size.width - 1.)/(columns - 1), (i/columns)*(size.height - 1.)/(rows - 1));
    SeenPoints all;
    for (int k = 0; k < depths; k++)
    {
        const double part = k/(depths - 1.), z = 1/((1 - part)/range[0] + part/range[1]);
        std::vector<Point3d> seen;
        cv::refract::refractivePointsOnPlane(grid, seen, camera, cv::Vec4d(0, 0, 1, z));
        for (size_t i = 0; i < grid.size(); i++)
            if (seen[i].z == seen[i].z)
            {
                all.points.push_back(seen[i]);
                all.pixels.push_back(grid[i]);
            }
    }
    all.allBeyondWindow = isBeyondWindow(camera, grid, range[0]);
    return all;
}

void requireEnough(const SeenPoints& seen, const cv::Vec2d& range, const std::string& name)
{
    const size_t FEWEST = 100;
    if (seen.points.size() < FEWEST || !seen.allBeyondWindow)
        throw Failure(cv::format("%s sees little or nothing of z = %g to %g: give a range beyond its window", name.c_str(),
                                 range[0], range[1]));
}

cv::Mat startingMatrix(const RefractiveCamera& camera)
{
    const cv::refract::GlassWindow window = camera.window();
    cv::Mat K = camera.cameraMatrix().clone();
    if (!isRound(window))           // a dome magnifies nothing, seen from its centre
        K.rowRange(0, 2).colRange(0, 2) *= window.outerIndex/window.innerIndex;
    return K;
}

CentralError errorOf(const SeenPoints& sample, const CentralCamera& central)
{
    std::vector<Point2d> seen;
    std::vector<Vec3d> origins, directions;
    cv::refract::refractiveProjectPoints(sample.points, central.pose.R, central.pose.T, central.camera, seen);
    cv::refract::refractiveUnprojectPoints(sample.pixels, origins, directions, central.camera);
    CentralError e;
    const auto n = (double)sample.points.size();
    const cv::Matx33d back = central.pose.R.t();
    for (size_t i = 0; i < sample.points.size(); i++)
    {
        // Where the ray that the central camera takes the pixel for passes the depth of the point.
        const Vec3d centre = central.pose.inverse(origins[i]), along = back*directions[i], X = sample.points[i];
        const double length = cv::norm(centre + along*((X[2] - centre[2])/along[2]) - X);
        const double px = cv::norm(seen[i] - sample.pixels[i]);
        // NaN counts as the worst there can be
        e.max = px <= e.max ? e.max : px;
        e.lengthMax = length <= e.lengthMax ? e.lengthMax : length;
        e.rms += px*px/n;
        e.lengthRms += length*length/n;
    }
    e.rms = std::sqrt(e.rms);
    e.lengthRms = std::sqrt(e.lengthRms);
    return e;
}

} // namespace tools
