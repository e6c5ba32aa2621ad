// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The joint problem on Ceres' trust region.

Ceres keeps bounds by projecting each step, and creeps where a step's other coordinates rely on the one that was cut off.
So every few iterations a coordinate that lies on its bound, with the cost falling beyond it, is held there, and is let go
when the cost falls towards the inside.

A small change of the cost is no proof of a minimum: the step that is left to that of the linearised problem must be far
below what the noise does. */

#include "adjust/minimize.hpp"
#include "adjust/inner.hpp"
#include "adjust/reduced_cost.hpp"
#include "adjust/silence.hpp"
#include "math/dense.hpp"
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

namespace cv { namespace refract {

namespace {

//! A few iterations of one kind of step.
struct TrustRegion
{
    ceres::TrustRegionStrategyType strategy;
    double change;          //!< of the cost, relative, that ends them
    double radius;          //!< of the first step; out: of the next
    int iterations = 0;     //!< at most; out: how many were made
    ceres::TerminationType outcome = ceres::NO_CONVERGENCE;     //!< out

    void solve(ceres::Problem& problem);
};

void TrustRegion::solve(ceres::Problem& problem)
{
    ceres::Solver::Options options;
    const double firstRadius = options.initial_trust_region_radius;
    options.trust_region_strategy_type = strategy;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = iterations;
    options.initial_trust_region_radius = radius;
    options.function_tolerance = change;
    options.gradient_tolerance = options.parameter_tolerance = 1e-14;
    options.max_num_consecutive_invalid_steps = 20;     // a step that takes a point's image away is shortened
    options.num_threads = 1;        // the cost has its own
    // At bounds Ceres searches along each step. What is not found soon is not found: the step is refused, and the next is shorter.
    options.max_num_line_search_step_size_iterations = 3;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    {
        const Silence silence;
        ceres::Solve(options, &problem, &summary);
    }
    iterations = std::max(1, (int)summary.iterations.size() - 1);
    const double COLLAPSED = 1e-20;                     // Ceres takes no start below 1e-32
    const bool isUsable = summary.IsSolutionUsable() && !summary.iterations.empty();
    radius = isUsable ? summary.iterations.back().trust_region_radius : firstRadius;
    if (!(radius > COLLAPSED))
        radius = firstRadius;
    outcome = isUsable ? summary.termination_type : ceres::FAILURE;
}

//! With its manifold and bounds.
void addBlock(ceres::Problem& problem, ParameterBlock& block)
{
    double* values = block.values.data();
    const int size = (int)block.values.size();
    problem.AddParameterBlock(values, size);
    std::vector<int> fixed;
    for (int i = 0; i < size; i++)
        if (!block.isFree[i] || block.isHeld[i])
            fixed.push_back(i);
        else if (std::isfinite(block.lower[i]))
            problem.SetParameterLowerBound(values, i, block.lower[i]);
    if (block.isOnManifold())
        problem.SetManifold(values, block.manifold().release());
    else if (!fixed.empty())
        problem.SetManifold(values, new ceres::SubsetManifold(size, fixed));
}

class Minimization
{
public:
    explicit Minimization(Problem& problem) : problem_(problem) {}
    FitOutcome run(const TermCriteria& criteria);

private:
    bool solve(TrustRegion& region);
    bool isOnBound() const;
    bool holdAtBounds();
    bool isAtMinimum() const;
    Problem& problem_;
    std::unique_ptr<ReducedCost> cost_;     //!< of what is not held
};

/** The problem comes to where Ceres ends, and the cost is linearised there.
@return false if the cost has no derivatives where it begins */
bool Minimization::solve(TrustRegion& region)
{
    if (!cost_)
        cost_.reset(new ReducedCost(problem_));
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(options);
    // Ceres has values of its own while it solves: the problem's are where the cost was asked for last.
    std::vector<Eigen::VectorXd> values;
    std::vector<double*> parameters;
    for (int i : cost_->variableBlocks())
        values.push_back(problem_.blocks()[i].values);
    const std::vector<Eigen::VectorXd> begin = values;
    const Eigen::VectorXd inner = innerValues(problem_);
    for (size_t k = 0; k < values.size(); k++)
    {
        ParameterBlock block = problem_.blocks()[cost_->variableBlocks()[k]];
        new (&block.values) Eigen::Map<Eigen::VectorXd>(values[k].data(), values[k].size());
        addBlock(problem, block);
        parameters.push_back(values[k].data());
    }
    if (!cost_->linearizeAt(parameters.data()))
        return false;
    if (parameters.empty())         // only inner blocks are free
    {
        region.outcome = ceres::CONVERGENCE;
        region.iterations = 1;
        return true;
    }
    problem.AddResidualBlock(cost_.get(), nullptr, parameters);
    region.solve(problem);
    if (cost_->linearizeAt(parameters.data()))
        return true;
    for (size_t k = 0; k < begin.size(); k++)
        problem_.blocks()[cost_->variableBlocks()[k]].values = begin[k];
    problem_.updateCameras();
    setInnerValues(problem_, inner);
    cost_.reset();
    region.outcome = ceres::FAILURE;
    return true;
}

bool Minimization::isOnBound() const
{
    for (const ParameterBlock& block : problem_.blocks())
        for (int i = 0; i < (int)block.values.size(); i++)
            if (block.isFree[i] && block.values[i] <= block.lower[i])
                return true;
    return false;
}

//! @return whether that changes what is held
bool Minimization::holdAtBounds()
{
    const FreeSpace space(problem_);
    const Information information = informationOf(problem_);
    const Eigen::VectorXd gradient = transposeTimesVector(information.root, information.residual);
    bool changed = false;
    for (int b = 0; b < problem_.outerCount(); b++)
    {
        ParameterBlock& block = problem_.blocks()[b];
        const Eigen::VectorXd ofBlock = timesVector(space.bases[b], gradient.segment(space.first[b], space.columnsOf(b)));
        for (int i = 0; i < (int)block.values.size(); i++)
        {
            const bool hold = block.isFree[i] && block.values[i] <= block.lower[i] && ofBlock[i] >= 0;
            changed = changed || hold != block.isHeld[i];
            block.isHeld[i] = hold;
        }
    }
    if (changed)
        cost_.reset();
    return changed;
}

//! The step that is left is far below the uncertainty of what it would move.
bool Minimization::isAtMinimum() const
{
    const double NEGLIGIBLE = 1e-3;     // standard deviations
    const double LEAST_SIGMA = problem_.hasScene() ? 1e-3 : 1e-6;   // px: perfect data end in rounding errors
    const double variance = problem_.freedom() > 0 ? problem_.squaredError()/problem_.freedom() : 0;
    return newtonDecrement(cost_->information()) < NEGLIGIBLE*std::max(std::sqrt(variance), LEAST_SIGMA);
}

/** Along curved valleys (distance against focal length) the steps of Levenberg and Marquardt creep, near the edge of the
domain those of the dogleg do: they take turns. Where a change of the cost is small that is not at a minimum, a smaller one is
asked for. */
FitOutcome Minimization::run(const TermCriteria& criteria)
{
    const int ITERATIONS_BETWEEN = 20;
    const bool stopsByChange = (criteria.type & TermCriteria::EPS) != 0;
    const double change = stopsByChange ? criteria.epsilon : 0., radius = ceres::Solver::Options().initial_trust_region_radius;
    const double STRICTER = 1e-2;
    const int IDLE = 40;                // turns of a single step in a row: more would not help either
    TrustRegion regions[] = { { ceres::LEVENBERG_MARQUARDT, change, radius }, { ceres::DOGLEG, change, radius } };
    int left = criteria.maxCount, idle = 0;
    for (int turn = 0; left > 0 && idle < IDLE; turn = 1 - turn)
    {
        TrustRegion& region = regions[turn];
        region.iterations = std::min(left, ITERATIONS_BETWEEN);
        if (!solve(region))
            break;
        if (region.outcome != ceres::FAILURE && !(isOnBound() && holdAtBounds()) && region.outcome == ceres::CONVERGENCE
            && isAtMinimum())
            return FitOutcome();
        left -= region.iterations;
        idle = region.iterations > 1 ? 0 : idle + 1;
        if (region.outcome == ceres::CONVERGENCE)
            region.change *= STRICTER;
    }
    // A caller who asks for a number of iterations only gets them; one who asks for a change must not get less.
    if (!stopsByChange)
        return FitOutcome();
    FitOutcome outcome = problem_.findPointAtWindow();
    outcome.status = FitOutcome::MAX_ITERATIONS;
    outcome.isStuck = left > 0;
    outcome.count = criteria.maxCount - std::max(left, 0);
    return outcome;
}

} // namespace

FitOutcome minimize(Problem& problem, const TermCriteria& criteria)
{
    const FitOutcome start = problem.findPointWithoutImage();
    return start.converged() ? Minimization(problem).run(criteria) : start;
}

}} // namespace
