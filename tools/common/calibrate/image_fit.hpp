// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_IMAGE_FIT_HPP
#define REFRACT_TOOLS_IMAGE_FIT_HPP

#include "calibrate/fit.hpp"
#include "calibrate/starting_model.hpp"

/* The joint fit of windows, rig and board poses to the images. Geometry is the library's. */
namespace tools {

const int MAX_ITERATIONS = 1000, MAX_ROBUST_ITERATIONS = 100;     // the latter in each of many rounds

//! calibrateGlassRig on some of the views.
Fit fitImages(const RigData& data, const RigModel& start, const std::vector<int>& views, int flags,
              int maxIterations = MAX_ITERATIONS);

/** Whether the next fits of these images may start where this one ended, without a search: only images through windows tell where several
cameras are, which takes seconds to search, and that search met no other plausible minimum. */
bool isOnlyMinimum(const RigData& data, const Fit& fit, int flags);

/** One fit of all images: lenses that came from images are free in it, so that their uncertainty is in every +-; direct
images are views too, each with its own pose. The windows are found first, with the lenses held.
@param flags gets GLASS_FREE_INTRINSICS if so
@param isPlaced the initial values are placed as an earlier fit has them, and no other minimum is looked for */
Fit fitAllImages(const RigData& data, const RigModel& start, const std::vector<LensSource>& lensSources, int& flags,
                 int maxIterations = MAX_ITERATIONS, bool isPlaced = false);

} // namespace tools

#endif // REFRACT_TOOLS_IMAGE_FIT_HPP
