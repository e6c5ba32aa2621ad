// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/trust_region.hpp"
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <algorithm>

namespace cv { namespace refract {

void TrustRegion::solve(ceres::Problem& problem, const std::shared_ptr<ceres::ParameterBlockOrdering>& ordering)
{
    ceres::Solver::Options options;
    const double firstRadius = options.initial_trust_region_radius;
    options.trust_region_strategy_type = strategy;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.linear_solver_ordering = ordering;
    options.max_num_iterations = iterations;
    options.initial_trust_region_radius = radius;
    options.function_tolerance = change;
    options.gradient_tolerance = options.parameter_tolerance = 1e-14;
    options.max_num_consecutive_invalid_steps = 20;     // a step that takes a point's image away is shortened
    options.num_threads = 1;        // sums in one order: the same result every time
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    iterations = std::max(1, (int)summary.iterations.size() - 1);
    const double COLLAPSED = 1e-20;                     // Ceres takes no start below 1e-32
    const bool isUsable = summary.IsSolutionUsable() && !summary.iterations.empty();
    radius = isUsable ? summary.iterations.back().trust_region_radius : firstRadius;
    if (!(radius > COLLAPSED))
        radius = firstRadius;
    outcome = isUsable ? summary.termination_type : ceres::FAILURE;
}

bool takeTurns(const TermCriteria& criteria, const std::function<bool(TrustRegion&)>& isDone)
{
    const int ITERATIONS_BETWEEN = 20;
    const bool stopsByChange = (criteria.type & TermCriteria::EPS) != 0;
    const double change = stopsByChange ? criteria.epsilon : 0., firstRadius = ceres::Solver::Options().initial_trust_region_radius;
    const double STRICTER = 1e-2;
    const int IDLE = 40;                // turns of a single step in a row: more would not help either
    TrustRegion regions[] = { { ceres::LEVENBERG_MARQUARDT, change, 0, firstRadius, ceres::NO_CONVERGENCE },
                              { ceres::DOGLEG, change, 0, firstRadius, ceres::NO_CONVERGENCE } };
    int left = criteria.maxCount, idle = 0;
    for (int turn = 0; left > 0 && idle < IDLE; turn = 1 - turn)
    {
        TrustRegion& region = regions[turn];
        region.iterations = std::min(left, ITERATIONS_BETWEEN);
        if (isDone(region))
            return true;
        left -= region.iterations;
        idle = region.iterations > 1 ? 0 : idle + 1;
        if (region.outcome == ceres::CONVERGENCE)
            region.change *= STRICTER;
    }
    // A caller who asks for a number of iterations only gets them; one who asks for a change must not get less.
    return !stopsByChange;
}

}} // namespace
