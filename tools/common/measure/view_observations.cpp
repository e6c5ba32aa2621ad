// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/view_observations.hpp"
#include "console/failure.hpp"
#include "math/dense.hpp"
#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using Eigen::VectorXd;

namespace tools {

//! The pose comes from the first of: direct images, glass images; of camera 1, of camera 2, ...
static bool startPose(const RigModel& rig, const View& view, ViewObservations& observed)
{
    for (bool glass : {false, true})
        for (int c = 0; c < (int)rig.cameras.size(); c++)
        {
            const std::vector<Point2d>& pixels = glass ? view.glass[c] : view.direct[c];
            const Ptr<RefractiveCamera> camera = glass ? rig.cameras[c] : copyWithWindow(rig.cameras[c], GlassWindow());
            if (pixels.empty() || !refractiveSolvePnP(pointsOfTarget(rig, view.objectPoints), pixels, camera, observed.rvec, observed.tvec))
                continue;
            poseFromImage(rig, c, glass, observed.rvec, observed.tvec);
            return true;
        }
    return false;
}

void addImage(const View& view, int camera, bool glass, ViewObservations& observed)
{
    const std::vector<Point2d>& points = (glass ? view.glass : view.direct)[camera];
    ImageOfView image{camera, glass, {}};
    std::vector<double> pixels(observed.pixels.data(), observed.pixels.data() + observed.pixels.size());
    for (size_t i = 0; i < points.size(); i++)
        if (seen(points[i]))
        {
            image.points.push_back((int)i);
            pixels.insert(pixels.end(), {points[i].x, points[i].y});
        }
    if (image.points.empty())
        return;
    observed.images.push_back(image);
    observed.pixels = Eigen::Map<VectorXd>(pixels.data(), pixels.size());
}

ViewObservations observationsOf(const RigModel& rig, const View& view)
{
    ViewObservations observed;
    observed.objectPoints = view.objectPoints;
    if (!startPose(rig, view, observed))
        throw Failure("no pose of the target explains its points in view '" + view.stem + "': check --size and --square");
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        for (bool glass : {false, true})
            addImage(view, c, glass, observed);
    return observed;
}

ViewDerivatives refinePose(const RigModel& rig, ViewObservations& observed)
{
    const int ITERATIONS = 4;       // from the pose that fits one of the images best
    ViewDerivatives derivatives = differentiateView(rig, observed.objectPoints, observed.rvec, observed.tvec, observed.images);
    for (int i = 0; i < ITERATIONS; i++)
    {
        const VectorXd step = PivotedQR(derivatives.byPose).solve(VectorXd(observed.pixels - derivatives.predicted));
        for (int k = 0; k < 3; k++)
        {
            observed.rvec[k] += step[k];
            observed.tvec[k] += step[3 + k];
        }
        derivatives = differentiateView(rig, observed.objectPoints, observed.rvec, observed.tvec, observed.images);
    }
    return derivatives;
}

} // namespace tools
