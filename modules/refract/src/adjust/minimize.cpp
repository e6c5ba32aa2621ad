// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The joint problem on Ceres' trust region; a scene's steps by Levenberg and Marquardt are its own (damped_steps.hpp).

Ceres keeps bounds by projecting each step, and creeps where a step's other coordinates rely on the one that was cut off.
So every few iterations a coordinate that lies on its bound, with the cost falling beyond it, is held there, and is let go
when the cost falls towards the inside. A window's distance has a second bound, the nearest target, beyond which there is no image:
where a target touches its window, with the cost falling beyond it, the distance is held a little before it.

A small change of the cost is no proof of a minimum: the step that is left to that of the linearised problem must be far
below what the noise does. */

#include "adjust/minimize.hpp"
#include "adjust/damped_steps.hpp"
#include "adjust/inner.hpp"
#include "adjust/reduced_cost.hpp"
#include "adjust/ceres_silence.hpp"
#include "math/dense.hpp"
#include "window/place.hpp"
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <opencv2/core/utils/logger.hpp>

namespace cv { namespace refract {

namespace {

//! A few iterations of one kind of step.
struct TrustRegion
{
    ceres::TrustRegionStrategyType strategy;
    double change;          //!< of the cost, relative, that ends them
    double radius;          //!< of the first step; out: of the next; of a scene's by Levenberg and Marquardt the inverse of the damping
    int iterations = 0;     //!< at most; out: how many were made
    ceres::TerminationType outcome = ceres::NO_CONVERGENCE;     //!< out
    bool isIdle = false;    //!< out: the same again would not move anything
    double leastGain = 0;   //!< of a scene's cost, relative: less is worth no step; 0: down to what cannot matter

    void solve(ceres::Problem& problem, bool isScene, bool isSparse);
};

void TrustRegion::solve(ceres::Problem& problem, bool isScene, bool isSparse)
{
    ceres::Solver::Options options;
    const double firstRadius = options.initial_trust_region_radius;
    options.trust_region_strategy_type = strategy;
    const bool hasSparse = options.sparse_linear_algebra_library_type != ceres::NO_SPARSE;     // a Ceres that was built without has none
    options.linear_solver_type = !isSparse ? ceres::DENSE_QR : hasSparse ? ceres::SPARSE_NORMAL_CHOLESKY : ceres::DENSE_NORMAL_CHOLESKY;
    options.max_num_iterations = iterations;
    options.initial_trust_region_radius = radius;
    options.function_tolerance = change;
    options.gradient_tolerance = options.parameter_tolerance = 1e-14;
    options.max_num_consecutive_invalid_steps = 20;     // a step that takes a point's image away is shortened
    options.num_threads = 1;        // the cost has its own
    // At bounds Ceres searches along each step. What is not found soon is not found: the step is refused, and the next is shorter.
    options.max_num_line_search_step_size_iterations = 3;
    if (isScene)                    // derivatives of where it is tried are dear, and what is predicted from there is far off
        options.line_search_interpolation_type = ceres::QUADRATIC;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    {
        const Silence silence;
        ceres::Solve(options, &problem, &summary);
    }
    iterations = std::max(1, (int)summary.iterations.size() - 1);
    const double COLLAPSED = 1e-20;                     // Ceres takes no start below 1e-32
    const double before = radius;
    const bool isUsable = summary.IsSolutionUsable() && !summary.iterations.empty();
    radius = isUsable ? summary.iterations.back().trust_region_radius : firstRadius;
    if (!(radius > COLLAPSED))
        radius = firstRadius;
    outcome = isUsable ? summary.termination_type : ceres::FAILURE;
    isIdle = summary.final_cost == summary.initial_cost && radius == before && !(change > 0.1*DBL_EPSILON);
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
    explicit Minimization(Problem& problem);
    FitOutcome run(const TermCriteria& criteria, double& damping, double leastGain);
    int iterations() const { return iterations_; }

private:
    bool solve(TrustRegion& region);
    void solve(TrustRegion& region, const std::vector<double*>& state);
    void descend(TrustRegion& region);
    bool isOnBound() const;
    bool holdAtBounds();
    bool touchesTarget(int block) const;
    bool isHeldAtTarget(int block) const;
    bool retreat(int block);
    bool isAtMinimum(double negligible);
    Problem& problem_;
    std::unique_ptr<ReducedCost> cost_;     //!< of what is not held
    int iterations_ = 0;
    std::vector<double> retreat_;           //!< per block: the part of its distance by which a window was moved from a target; 0: not
};

const double FIRST_RETREAT = 1e-4, LAST_RETREAT = 1e-2;     // parts of the distance

//! The coordinate of a free distance; -1: the block has none.
int freeDistance(const ParameterBlock& block)
{
    const int i = block.at.distance - block.at.media;
    return block.kind == ParameterBlock::MEDIA && !hasCenter(block.at.shape) && block.isFree[i] ? i : -1;
}

//! An earlier call on the same problem may have left distances where they are held.
Minimization::Minimization(Problem& problem) : problem_(problem), retreat_(problem.blocks().size(), 0.)
{
    for (size_t b = 0; b < retreat_.size(); b++)
    {
        const ParameterBlock& block = problem.blocks()[b];
        const int i = freeDistance(block);
        if (i >= 0 && block.isHeld[i] && problem.findPointAtWindow(2*LAST_RETREAT, block.index).pointIndex >= 0)
            retreat_[b] = FIRST_RETREAT;
    }
}

//! From the state of the cost, and there.
void Minimization::solve(TrustRegion& region, const std::vector<double*>& state)
{
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.evaluation_callback = cost_.get();
    std::vector<std::unique_ptr<ReducedCost::Group> > groups;       // they outlive it
    ceres::Problem problem(options);
    for (size_t k = 0; k < state.size(); k++)
    {
        ParameterBlock block = problem_.blocks()[cost_->variableBlocks()[k]];
        new (&block.values) Eigen::Map<Eigen::VectorXd>(state[k], block.values.size());
        addBlock(problem, block);
    }
    for (int i = 0; i < cost_->groupCount(); i++)
    {
        groups.emplace_back(new ReducedCost::Group(*cost_, i));
        std::vector<double*> parameters;
        for (int block : groups.back()->blocks())
            parameters.push_back(state[block]);
        problem.AddResidualBlock(groups.back().get(), nullptr, parameters);
    }
    region.solve(problem, problem_.hasScene(), groups.size() > 1);
}

//! Of predicted ones, px: a camera far from the scene's origin loses digits of where its points are.
static double roundingOfPixels(const Problem& problem)
{
    const double LEAST = 1e-12, MOST = 1e-8;        // beyond it the scene's origin is to be moved
    double most = LEAST;
    const Rig rig = problem.rig();
    for (const Image& image : problem.images())
    {
        const Pose pose = problem.pose(image.view);
        const size_t row = std::find_if(image.rootWeights.begin(), image.rootWeights.end(), [](double w) { return w > 0; })
                           - image.rootWeights.begin();
        if (row == image.rootWeights.size() || !pose.found)
            continue;
        const Vec3d X = problem.sceneScale()*Vec3d(image.points.object[row]), inCamera1 = rotationMatrix(pose.rvec)*X + pose.tvec;
        const Vec3d inCamera = TransformWithDerivatives(rig.extrinsics[image.camera]).apply(inCamera1);
        const double focalLength = rig.cameras[image.camera].lens().parameters()[0];
        most = std::max(most, DBL_EPSILON*std::max(norm(X), norm(pose.tvec))*focalLength/norm(inCamera));
    }
    return std::min(most, MOST);
}

void Minimization::descend(TrustRegion& region)
{
    DampedSteps steps = { (double)problem_.equationCount(), region.change, 1/region.radius, region.iterations, false, region.leastGain,
                          roundingOfPixels(problem_) };
    const double begin = cost_->squaredError(), before = region.radius;
    steps.run(*cost_);
    region.iterations = std::max(1, steps.iterations);
    region.radius = 1/steps.damping;
    region.outcome = steps.isConverged ? ceres::CONVERGENCE : ceres::NO_CONVERGENCE;
    region.isIdle = cost_->squaredError() == begin && region.radius == before && !(region.change > 0.1*DBL_EPSILON);
}

/** The problem comes to where Ceres ends, and the cost is linearised there.
@return false if the cost has no derivatives where it begins */
bool Minimization::solve(TrustRegion& region)
{
    if (!cost_)
        cost_.reset(new ReducedCost(problem_));
    // Ceres has values of its own while it solves: the problem's are where the cost was asked for last.
    std::vector<Eigen::VectorXd> values;
    std::vector<double*> state;
    for (int i : cost_->variableBlocks())
        values.push_back(problem_.blocks()[i].values);
    const std::vector<Eigen::VectorXd> begin = values;
    const Eigen::VectorXd inner = innerValues(problem_);
    for (Eigen::VectorXd& block : values)
        state.push_back(block.data());
    cost_->setState(state);
    if (!cost_->linearize())
    {
        cost_.reset();              // it has no information that could be asked for
        return false;
    }
    if (state.empty())              // only inner blocks are free
    {
        region.outcome = ceres::CONVERGENCE;
        region.iterations = 1;
        region.isIdle = true;
        return true;
    }
    if (problem_.hasScene() && region.strategy == ceres::LEVENBERG_MARQUARDT)
        descend(region);
    else
        solve(region, state);
    if (cost_->linearize())
        return true;
    for (size_t k = 0; k < begin.size(); k++)
        problem_.blocks()[cost_->variableBlocks()[k]].values = begin[k];
    problem_.updateCameras();
    setInnerValues(problem_, inner);
    cost_.reset();
    region.outcome = ceres::FAILURE;
    return true;
}

//! Whether the block has a distance that is free, and a target touches its window.
bool Minimization::touchesTarget(int b) const
{
    const double TOUCHES = 1e-5;        // part of the distance
    const ParameterBlock& block = problem_.blocks()[b];
    return freeDistance(block) >= 0 && problem_.findPointAtWindow(TOUCHES, block.index).pointIndex >= 0;
}

bool Minimization::isHeldAtTarget(int b) const
{
    const ParameterBlock& block = problem_.blocks()[b];
    return retreat_[b] > 0 && block.isHeld[freeDistance(block)] &&
           problem_.findPointAtWindow(2*LAST_RETREAT, block.index).pointIndex >= 0;
}

bool Minimization::isOnBound() const
{
    for (int b = 0; b < (int)problem_.blocks().size(); b++)
    {
        const ParameterBlock& block = problem_.blocks()[b];
        for (int i = 0; i < (int)block.values.size(); i++)
            if (block.isFree[i] && block.values[i] <= block.lower[i])
                return true;
        if (isHeldAtTarget(b) || touchesTarget(b))
            return true;
    }
    return false;
}

//! Moves a window that a target touches ever farther from it, so that all else may move; false if it has gone far already.
bool Minimization::retreat(int b)
{
    if (retreat_[b] >= LAST_RETREAT)
        return false;
    retreat_[b] = std::max(FIRST_RETREAT, 10*retreat_[b]);
    ParameterBlock& block = problem_.blocks()[b];
    block.values[freeDistance(block)] *= 1 - retreat_[b];
    problem_.updateCameras();
    return true;
}

//! @return whether that changes what is held, or where
bool Minimization::holdAtBounds()
{
    const FreeSpace space(problem_);
    const Eigen::VectorXd gradient = gradientOfCameras(informationOf(problem_));
    bool changed = false;
    for (int b = 0; b < problem_.cameraBlockCount(); b++)
    {
        ParameterBlock& block = problem_.blocks()[b];
        const Eigen::VectorXd ofBlock = timesVector(space.bases[b], gradient.segment(space.first[b], space.columnsOf(b)));
        const bool touches = touchesTarget(b), isNearTarget = touches || isHeldAtTarget(b);
        for (int i = 0; i < (int)block.values.size(); i++)
        {
            const bool atTarget = isNearTarget && i == freeDistance(block) && ofBlock[i] <= 0;
            const bool hold = block.isFree[i] && (atTarget || (block.values[i] <= block.lower[i] && ofBlock[i] >= 0));
            changed = changed || hold != block.isHeld[i];
            block.isHeld[i] = hold;
            changed = (atTarget && touches && retreat(b)) || changed;
        }
    }
    if (changed)
        cost_.reset();
    return changed;
}

/** The step that is left is far below the uncertainty of what it would move, or what is not seen.
@param negligible standard deviations */
bool Minimization::isAtMinimum(double negligible)
{
    const double LEAST_SIGMA = problem_.hasScene() ? 1e-3 : 1e-6;   // px: perfect data end in rounding errors
    const double variance = problem_.freedom() > 0 ? problem_.squaredError()/problem_.freedom() : 0;
    const double decrement = newtonDecrement(cost_->rootedInformation()), unseen = problem_.hasScene() ?
        DampedSteps::unseenOf(problem_.squaredError(), problem_.equationCount(), roundingOfPixels(problem_)) : 0;
    return decrement < negligible*std::max(std::sqrt(variance), LEAST_SIGMA) || decrement*decrement < unseen;
}

/** Along curved valleys (distance against focal length) the steps of Levenberg and Marquardt creep, near the edge of the
domain those of the dogleg do: they take turns. Where a change of the cost is small that is not at a minimum, a smaller one is
asked for; of a scene, whose turns by the dogleg are dear, of the same steps first. */
FitOutcome Minimization::run(const TermCriteria& criteria, double& damping, double leastGain)
{
    const int ITERATIONS_BETWEEN = 20;
    const double NEGLIGIBLE = 1e-3, NEGLIGIBLE_BY_ROUNDING = 1e-2;
    const bool stopsByChange = (criteria.type & TermCriteria::EPS) != 0;
    const double change = stopsByChange ? criteria.epsilon : 0., radius = 1/FIRST_DAMPING;
    const double STRICTER = 1e-2;
    const int IDLE = 40;                // turns of a single step in a row: more would not help either
    const TrustRegion fresh[] = { { ceres::LEVENBERG_MARQUARDT, change, radius }, { ceres::DOGLEG, change, radius } };
    TrustRegion regions[] = { fresh[0], fresh[1] };
    regions[0].leastGain = problem_.hasScene() ? leastGain : 0;
    regions[0].radius = std::max(1/damping, radius);        // exact data end where no step gains anything, whatever the damping
    int idle = 0;
    bool isAgain = false;
    for (int turn = 0; iterations_ < criteria.maxCount && idle < IDLE && !(regions[0].isIdle && regions[1].isIdle);
         turn = isAgain ? turn : 1 - turn)
    {
        TrustRegion& region = regions[turn];
        region.iterations = std::min(criteria.maxCount - iterations_, ITERATIONS_BETWEEN);
        if (!solve(region))
            break;
        damping = 1/regions[0].radius;
        const bool isHeldAnew = region.outcome != ceres::FAILURE && isOnBound() && holdAtBounds();
        iterations_ += region.iterations;
        CV_LOG_INFO(NULL, "refract: " << (turn ? "dogleg" : "Levenberg-Marquardt") << " to " << problem_.squaredError() << ", "
                     << region.iterations << " iterations");
        if (region.outcome == ceres::CONVERGENCE && !isHeldAnew && (region.leastGain > 0 || isAtMinimum(NEGLIGIBLE)))
            return FitOutcome();
        idle = region.iterations > 1 ? 0 : idle + 1;
        isAgain = problem_.hasScene() && turn == 0 && !isAgain && region.outcome == ceres::CONVERGENCE && !isHeldAnew;
        if (region.outcome == ceres::CONVERGENCE)
            region.change *= STRICTER;
        if (isHeldAnew && std::any_of(retreat_.begin(), retreat_.end(), [](double part) { return part > 0; }))
        {
            std::copy(fresh, fresh + 2, regions);       // no step was long on the way to the target
            idle = 0;
        }
    }
    // A caller who asks for a number of iterations only gets them; one who asks for a change must not get less.
    if (!stopsByChange)
        return FitOutcome();
    // Far from a scene's origin rounding ends the steps: no smaller one makes it better.
    const bool isStuck = iterations_ < criteria.maxCount;
    if (isStuck && cost_ && problem_.hasScene() && isAtMinimum(NEGLIGIBLE_BY_ROUNDING))
        return FitOutcome();
    const double ALL_BUT_TOUCHES = 1e-3;
    FitOutcome outcome = problem_.findPointAtWindow(ALL_BUT_TOUCHES);
    outcome.status = FitOutcome::MAX_ITERATIONS;
    outcome.isStuck = isStuck;
    outcome.count = std::min(iterations_, criteria.maxCount);
    return outcome;
}

} // namespace

FitOutcome minimize(Problem& problem, const TermCriteria& criteria, double& damping, double leastGain)
{
    const FitOutcome start = problem.findPointWithoutImage();
    if (!start.converged())
        return start;
    const int64 begin = getTickCount();
    Minimization minimization(problem);
    const FitOutcome outcome = minimization.run(criteria, damping, leastGain);
    CV_LOG_INFO(NULL, "refract: " << minimization.iterations() << " iterations of " << problem.equationCount() << " equations in "
                << (double)(getTickCount() - begin)/getTickFrequency() << " s");
    return outcome;
}

FitOutcome minimize(Problem& problem, const TermCriteria& criteria)
{
    double damping = FIRST_DAMPING;
    return minimize(problem, criteria, damping);
}

}} // namespace
