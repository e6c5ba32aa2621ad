// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PIXEL_NOISE_HPP
#define REFRACT_TOOLS_PIXEL_NOISE_HPP

#include "accept/test_points.hpp"

namespace tools {

//! The noise of a pixel coordinate of a test, and what its reader should know of it, a sentence each.
struct PixelNoise
{
    double sigma;
    std::vector<std::string> remarks;
};

/** As the caller states it, or as the calibration's residuals have it; more where the points' own rays miss each other by more. Throws
Failure where they refute what is stated.
@param stated --pixel-sigma; 0: not stated */
PixelNoise pixelNoiseOf(const Calibration& calibration, const TestPoints& points, double stated);

} // namespace tools

#endif // REFRACT_TOOLS_PIXEL_NOISE_HPP
