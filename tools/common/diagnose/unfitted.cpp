// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/unfitted.hpp"
#include "calibrate/parameter_columns.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! Object -> camera 1 by the first image that gives a pose: without the window if there is one, whose tilt is not known yet.
bool poseOf(const View& view, const RigModel& rig, Vec3d& rvec, Vec3d& tvec)
{
    for (bool glass : {false, true})
        for (int c = 0; c < (int)rig.cameras.size(); c++)
        {
            const std::vector<Point2d>& pixels = (glass ? view.glass : view.direct)[c];
            if (pixels.empty() || !refractiveSolvePnP(view.objectPoints, pixels, glass ? rig.cameras[c]
                                                      : copyWithWindow(rig.cameras[c], GlassWindow()), rvec, tvec))
                continue;
            poseInCamera1(rig, c, rvec, tvec);
            return true;
        }
    return false;
}

//! Of each number of the cameras and their places: 1 if a fit estimates it without knowing anything of it, else 0.
std::vector<double> freeNumbers(const RigModel& rig, const std::vector<LensSource>& lensSources, int flags)
{
    std::vector<double> free(columnCount(rig), 0.);
    const auto set = [&free](int first, int count, bool isFree) {
        for (int i = first; i < first + count; i++)
            free[i] = isFree; };
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        set(at.lens, at.lensCount, lensSources[c].kind != LensSource::FROM_FILE || (flags & GLASS_FREE_INTRINSICS));
        if (c > 0)
            set(extrinsicsColumn(rig, c), 6, true);
        if (!rig.ownsWindow(c))
            continue;
        set(at.distance, 1, flags & GLASS_FREE_DISTANCE);
        set(at.thickness, at.layers, flags & GLASS_FREE_THICKNESS);
        set(at.index, at.layers, flags & GLASS_FREE_INDEX);
        set(at.outerIndex, 1, flags & GLASS_FREE_OUTER_INDEX);
    }
    return free;
}

int countSeen(const View& view, int cameras)
{
    int count = 0;
    for (int c = 0; c < cameras; c++)
        for (const std::vector<Point2d>* pixels : {&view.direct[c], &view.glass[c]})
            count += (int)std::count_if(pixels->begin(), pixels->end(), seen);
    return count;
}

} // namespace

Fit unfitted(const RigData& data, const RigModel& start, const std::vector<LensSource>& lensSources, int flags)
{
    Fit fit;
    fit.rig = start.clone();
    for (int i = 0; i < (int)data.views.size(); i++)
    {
        const View& view = data.views[i];
        Vec3d rvec, tvec;
        if ((flags & GLASS_USE_POSES) && view.pose)
            rvec = view.pose->rvec, tvec = view.pose->tvec;
        else if (!poseOf(view, start, rvec, tvec))
            continue;
        fit.views.push_back(i);
        fit.rvecs.push_back(rvec);
        fit.tvecs.push_back(tvec);
        fit.dof += 2.*countSeen(view, data.cameraCount) - (flags & GLASS_USE_POSES ? 0. : 6.);
    }
    const std::vector<double> free = freeNumbers(start, lensSources, flags);
    fit.stdDeviations = Mat(free, true);
    fit.dof -= std::accumulate(free.begin(), free.end(), 0.) + 2.*countWindows(start);      // and a normal of each window
    double squares = 0.;
    const std::vector<Residual> residuals = residualsOf(data, fit);
    for (const Residual& r : residuals)
        squares += r.error.dot(r.error);
    fit.sigma = std::sqrt(squares/std::max(1., fit.dof));
    return fit;
}

} // namespace tools
