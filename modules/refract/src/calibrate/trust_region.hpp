// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_TRUST_REGION_HPP
#define OPENCV_REFRACT_TRUST_REGION_HPP

#include <opencv2/core.hpp>
#include <ceres/ordered_groups.h>
#include <ceres/types.h>
#include <functional>
#include <memory>

namespace ceres { class Problem; }

namespace cv { namespace refract {

//! A few iterations of one kind of step.
struct TrustRegion
{
    ceres::TrustRegionStrategyType strategy;
    double change;          //!< of the cost, relative, that ends them
    int iterations;         //!< at most; out: how many were made
    double radius;          //!< of the first step; out: of the next
    ceres::TerminationType outcome;     //!< out

    //! The group 0 of the ordering is eliminated.
    void solve(ceres::Problem& problem, const std::shared_ptr<ceres::ParameterBlockOrdering>& ordering);
};

/** Along curved valleys (distance against focal length) the steps of Levenberg and Marquardt creep, near the edge of the
domain those of the dogleg do: they take turns. Where a change of the cost is small that is not at a minimum, a smaller one is
asked for.
@param isDone makes some iterations; true where that ended in a minimum
@return false if criteria.maxCount iterations, or all that moved anything, did not reach it, and the criteria ask for a change of
the cost (EPS) */
bool takeTurns(const TermCriteria& criteria, const std::function<bool(TrustRegion&)>& isDone);

}} // namespace

#endif // OPENCV_REFRACT_TRUST_REGION_HPP
