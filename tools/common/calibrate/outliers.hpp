// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_OUTLIERS_HPP
#define REFRACT_TOOLS_OUTLIERS_HPP

#include "calibrate/fit.hpp"
#include "calibrate/starting_model.hpp"
#include <optional>

/* Outliers: hidden, smeared or wrongly detected points (dirty glass), and images whose target was moved. A robust fit of all data
(GLASS_ROBUST) finds them. They are removed before the calibration itself. */
namespace tools {

//! The observations that are rejected in one image.
struct Rejected
{
    std::string view;
    int camera;
    bool glass;
    int points;                 //!< of those seen
    bool image;                 //!< the whole image
    std::string why;

    std::string sentence() const;
};

struct Outliers
{
    std::vector<Rejected> rejected;
    std::string fault;          //!< why the robust fit failed, so that nothing is rejected; empty: it did not fail
};

//! Removes outliers from the data. Removes nothing if the robust fit is not possible. @param maxIterations of each of its many solutions
Outliers rejectOutliers(RigData& data, const RigModel& start, int flags, int maxIterations = MAX_ROBUST_ITERATIONS);

/** The same, where a lens from few direct images is less exact than the corners, so that good images contradict it. If whole images
would be rejected, or the fit fails, the fit with a free lens (as in the calibration itself) decides what is an outlier. */
Outliers rejectOutliers(RigData& data, const RigModel& start, int flags, const std::vector<LensSource>& lensSources,
                        int maxIterations = MAX_ROBUST_ITERATIONS);

/** The same, where the initial values come from the data and contain their outliers. All data are tested again, from the initial values
of the inliers, until the outliers do not change.
@param start, lensSources result: as of startModel, from the inliers
@param only where a fit of all the data met the only minimum: the initial values are placed there. Where more than single points are
outliers they may have hidden another minimum: all is searched, and this is reset. */
Outliers startWithoutOutliers(RigData& data, const RigOptions& options, RigModel& start, std::vector<LensSource>& lensSources,
                              int maxIterations, std::optional<RigModel>& only);
Outliers startWithoutOutliers(RigData& data, const RigOptions& options, RigModel& start,
                              std::vector<LensSource>& lensSources, int maxIterations = MAX_ROBUST_ITERATIONS);

/* Images that have no pose: they show too few points of the target, or points on one line. */

/** Removes them from the sets.
@param target null: all points have coordinates of their own
@return what was removed; images without any point are not listed
Throws Failure where nothing would be left of a camera's direct images, or of those through the window. */
std::vector<Rejected> leaveOutFewPoints(const Target* target, RigImages& sets);

} // namespace tools

#endif // REFRACT_TOOLS_OUTLIERS_HPP
