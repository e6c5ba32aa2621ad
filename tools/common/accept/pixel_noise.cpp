// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/pixel_noise.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"
#include "measure/consistency.hpp"
#include <limits>

namespace tools {

namespace {

//! The points that count, measured by this calibration.
Measurement measurementOf(const TestPoints& points, const Calibration& calibration)
{
    RigPixels pixels(calibration.cameras.size());
    for (const TestPoint& point : points.points)
        for (size_t c = 0; c < pixels.size() && point.status == 0; c++)
            pixels[c].push_back(point.pixels[c]);
    return measureRig(calibration, pixels, pixelSigmaOf(calibration));
}

//! Stated, and nothing of these points refutes it.
std::vector<std::string> remarksOfStated(const TestPoints& points, double stated, double calibrated, double shown)
{
    const std::string given = format("--pixel-sigma=%.3g", stated);
    if (!points.havePixels && points.haveSigma)
        return {given + " is not used: the points have no pixels, and sx, sy, sz say their noise"};
    if (!(stated < calibrated))
        return {};
    const std::string less = given + format(" is less than the %.2g px of the calibration's residuals", calibrated);
    return {shown > 0. ? less + format("; the points' own rays miss each other by as much as %.2g px make", shown)
                       : less + ", and nothing in these points supports it"};
}

} // namespace

PixelNoise pixelNoiseOf(const Calibration& calibration, const TestPoints& points, double stated)
{
    const double calibrated = pixelSigmaOf(calibration);
    if (!points.havePixels || calibration.single())
    {
        const double none = std::numeric_limits<double>::quiet_NaN();
        return stated > 0 ? PixelNoise{stated, remarksOfStated(points, stated, calibrated, none)} : PixelNoise{calibrated, {}};
    }
    const ShownNoise shown(calibration, measurementOf(points, calibration));
    if (stated > 0 && shown.isMoreThan(stated))
        throw Failure(format("--pixel-sigma=%.3g: the pixels of '", stated) + points.source
                      + format("' have a noise of %.2g px, as the rays of a point miss each other by that much; leave it out, or give what "
                               "is so", shown.sigma()));
    if (stated > 0)
        return {stated, remarksOfStated(points, stated, calibrated, shown.sigma())};
    if (!(calibrated > 0) || !shown.isMoreThan(calibrated))
        return {calibrated, {}};
    return {shown.sigma(), {format("The pixels of these points are noisier than those of the calibration, %.2g px in place of %.2g px: U "
                                   "has the larger one", shown.sigma(), calibrated)}};
}

} // namespace tools
