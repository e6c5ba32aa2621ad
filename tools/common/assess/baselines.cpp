// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/baselines.hpp"
#include "calibrate/pinhole_camera.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

Ptr<RefractiveCamera> pinholeOrNone(const RigData& data, const RigModel& rig, int camera, const std::vector<int>& views)
{
    try
    {
        return calibratePinholeThroughGlass(data, camera, views, pinholeCoefficients(rig, camera)).camera;
    }
    catch (const std::exception&)
    {
        return Ptr<RefractiveCamera>();     // too few images, or no such lens
    }
}

//! RMS px between the two images of each corner of a pair: what ignoring the glass costs if the board cannot give way.
double shiftOfPairs(const RigData& data, int camera)
{
    double sum = 0.;
    int count = 0;
    for (const View& view : data.views)
        for (size_t i = 0; view.isPair(camera) && i < view.glass[camera].size(); i++)
        {
            const Point2d d = view.glass[camera][i] - view.direct[camera][i];
            if (!seen(d))
                continue;
            sum += d.dot(d);
            count++;
        }
    return count ? std::sqrt(sum/count) : NONE;
}

} // namespace

void PooledRms::add(const std::vector<Point3d>& object, const std::vector<Point2d>& pixels,
                    const Ptr<RefractiveCamera>& camera)
{
    if (pixels.empty())
        return;
    Vec3d rvec, tvec;
    std::vector<double> error;
    const bool found = refractiveSolvePnP(object, pixels, camera, rvec, tvec, false, error);
    const int n = (int)std::count_if(pixels.begin(), pixels.end(), seen);
    sum_ += found ? 2.*error[0]*error[0]*n : NONE;      // a view without a pose makes the whole NaN
    count_ += n;
}

Baselines computeBaselines(const RigData& data, const RigModel& start, const std::vector<LensSource>& lensSources)
{
    Baselines result;
    for (int c = 0; c < data.cameraCount; c++)
    {
        const Ptr<RefractiveCamera> pinhole = pinholeOrNone(data, start, c, allViews(data));
        const Ptr<RefractiveCamera> bare = copyWithWindow(start.cameras[c], GlassWindow());
        PooledRms ignored, through;
        for (const View& view : data.views)
        {
            ignored.add(view.objectPoints, view.glass[c], bare);
            if (pinhole)
                through.add(view.objectPoints, view.glass[c], pinhole);
        }
        // A lens that itself came from the glass images knows no "without".
        const bool airLens = lensSources[c].kind != LensSource::FROM_GLASS;
        result.glassIgnored.push_back(airLens ? ignored.value() : NONE);
        result.shift.push_back(shiftOfPairs(data, c));
        result.throughGlass.push_back(through.value());
    }
    return result;
}

double rmsOfSeparateFits(const Baselines& baselines, const std::vector<LensSource>& lensSources)
{
    double largest = 0.;
    for (size_t c = 0; c < lensSources.size(); c++)
        largest = std::max({largest, baselines.throughGlass[c], lensSources[c].rms});
    return largest;
}

} // namespace tools
