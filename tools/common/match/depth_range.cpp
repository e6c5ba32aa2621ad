// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/depth_range.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"

#include <cmath>

namespace tools {

using cv::format;
using cv::Point2d;

bool isBeyondWindows(const Calibration& calibration, double z)
{
    if (std::isinf(z))
        return true;
    const auto& camera = calibration.cameras[0].camera;
    const Point2d middle((camera->imageSize().width - 1)/2., (camera->imageSize().height - 1)/2.);
    std::vector<cv::Vec3d> X;
    cv::refract::refractivePointsOnPlane(std::vector<Point2d>{middle}, X, camera, cv::Vec4d(0, 0, 1, z));
    return std::isfinite(X[0][2]);
}

std::vector<cv::Point3d> pointsAtDepth(const cv::Ptr<cv::refract::RefractiveCamera>& camera, double z, int steps)
{
    const cv::Size size = camera->imageSize();
    std::vector<Point2d> pixels;
    for (int i = 0; i <= steps; i++)
        for (int j = 0; j <= steps; j++)
            pixels.push_back(Point2d((size.width - 1)*i/(double)steps, (size.height - 1)*j/(double)steps));
    std::vector<cv::Point3d> points;
    cv::refract::refractivePointsOnPlane(pixels, points, camera, cv::Vec4d(0, 0, 1, z));
    return points;
}

cv::Vec2d givenDepthRange(const std::string& text, const Calibration& calibration)
{
    const cv::Vec2d range = parseDepthRange(text, "--depth");
    if (!isBeyondWindows(calibration, range[1]))
        throw Failure("--depth=" + text + ": that is before or in the window of camera 1; give z of the scene beyond it, in the unit of "
                      "the calibration");
    if (!isBeyondWindows(calibration, range[0]))
        throw Failure("--depth=" + text + format(": NEAR=%g is before or in the window of camera 1; give z of the scene beyond it",
                                                 range[0]));
    return range;
}

cv::Vec2d calibratedDepthRange(const Calibration& calibration, const std::string& filename)
{
    const double BEYOND = 1.5;
    const auto& volume = calibration.provenance.volume;
    if (!volume || !(volume->least.z > 0))
        throw Failure("'" + filename + "' does not say where the calibrated volume was: give --depth=NEAR,FAR, the z of the scene in the "
                      "frame of camera 1");
    const double near = volume->least.z/BEYOND;
    return cv::Vec2d(isBeyondWindows(calibration, near) ? near : volume->least.z, BEYOND*volume->most.z);
}

} // namespace tools
