// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/fit.hpp"

using namespace cv;
using namespace cv::refract;

namespace tools {

void poseInCamera(const Fit& fit, size_t k, int camera, Vec3d& rvec, Vec3d& tvec)
{
    rvec = fit.rvecs[k];
    tvec = fit.tvecs[k];
    poseInCamera(fit.rig, camera, rvec, tvec);
}

std::vector<Residual> residualsOf(const RigData& data, const Fit& fit)
{
    std::vector<Residual> residuals;
    for (int c = 0; c < data.cameraCount; c++)
    {
        const Ptr<RefractiveCamera> through = fit.rig.cameras[c], bare = copyWithWindow(through, GlassWindow());
        for (size_t k = 0; k < fit.views.size(); k++)
        {
            for (bool glass : {true, false})
            {
                Vec3d rvec = fit.rvecs[k], tvec = fit.tvecs[k];
                poseInImage(fit.rig, c, glass, rvec, tvec);
                const View& view = data.views[fit.views[k]];
                const std::vector<Point2d>& pixels = glass ? view.glass[c] : view.direct[c];
                if (pixels.empty())
                    continue;
                std::vector<Point2d> modelled;
                refractiveProjectPoints(pointsOfTarget(fit.rig, view.objectPoints), rvec, tvec, glass ? through : bare, modelled);
                for (size_t i = 0; i < pixels.size(); i++)
                    if (seen(pixels[i]))
                        residuals.push_back({c, fit.views[k], glass, pixels[i], pixels[i] - modelled[i]});
            }
        }
    }
    return residuals;
}

} // namespace tools
