// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/reduced_cost.hpp"
#include "adjust/inner.hpp"
#include "math/dense.hpp"
#include <ceres/manifold.h>

namespace cv { namespace refract {

using Eigen::VectorXd;

ReducedCost::ReducedCost(Problem& problem)
    : problem_(problem), cameras_(0), isPossible_(false), isCurrent_(false), isAnchor_(false), isLinear_(false), squaredError_(0)
{
    const FreeSpace space(problem, false);
    for (int block = 0; block < problem.outerCount(); block++)
        if (space.columnsOf(block) > 0)
            variable_.push_back(block);
    for (int block : variable_)
        cameras_ += problem.blocks()[block].kind != ParameterBlock::POSE;
    if (problem.hasScene())
        graph_.reset(new ViewGraph(problem));
}

//! The problem to the state; false if it is there already.
bool ReducedCost::move()
{
    bool hasMoved = false;
    for (size_t i = 0; i < variable_.size(); i++)
    {
        Eigen::Map<VectorXd>& values = problem_.blocks()[variable_[i]].values;
        const Eigen::Map<const VectorXd> wanted(state_[i], values.size());
        hasMoved = hasMoved || values != wanted;
        values = wanted;
    }
    problem_.updateCameras();
    return hasMoved;
}

//! Other values of a block after a step of its free coordinates, no lower than their bounds.
static VectorXd moved(const ParameterBlock& block, const VectorXd& from, const VectorXd& step)
{
    if (!block.isOnManifold())
        return (from + timesVector(block.tangentBasis(false), step)).cwiseMax(Eigen::Map<const VectorXd>(block.lower.data(), from.size()));
    const std::unique_ptr<ceres::Manifold> manifold = block.manifold();
    RowMajorMatrix basis(from.size(), manifold->TangentSize());
    manifold->PlusJacobian(from.data(), basis.data());
    const VectorXd scaled = step.cwiseQuotient(basis.colwise().norm().transpose());
    VectorXd to(from.size());
    manifold->Plus(from.data(), scaled.data(), to.data());
    return to;
}

bool ReducedCost::isPose(size_t variable) const { return problem_.blocks()[variable_[variable]].kind == ParameterBlock::POSE; }

void ReducedCost::setStep(const VectorXd& step)
{
    std::vector<Vector6> steps(problem_.viewCount(), Vector6::Zero());
    for (size_t i = 0; i < variable_.size(); i++)
        if (isPose(i))
            steps[problem_.blocks()[variable_[i]].index] = step.segment<6>(anchor_->space.first[variable_[i]]);
    const std::vector<Vector6> poses = anchor_->motion->posesAfter(steps);
    for (size_t i = 0; i < variable_.size(); i++)
    {
        const ParameterBlock& block = problem_.blocks()[variable_[i]];
        Eigen::Map<VectorXd> state(state_[i], block.values.size());
        if (isPose(i))
            state = poses[block.index];
        else
            state = moved(block, anchor_->values[i],
                          step.segment(anchor_->space.first[variable_[i]], anchor_->space.columnsOf(variable_[i])));
    }
}

void ReducedCost::restore()
{
    for (size_t i = 0; i < variable_.size(); i++)
        Eigen::Map<VectorXd>(state_[i], anchor_->values[i].size()) = anchor_->values[i];
    move();
    setInnerValues(problem_, anchor_->inner);
    squaredError_ = anchor_->squaredError;
    isCurrent_ = isAnchor_ = true;
}

//! The step of the free coordinates that leads from the anchor to where the problem is.
VectorXd ReducedCost::stepFromAnchor()
{
    std::vector<Vector6> steps;
    for (int view = 0; anchor_->motion && view < problem_.viewCount(); view++)
        steps.push_back(problem_.blocks()[problem_.poseBlock(view)].values);
    if (anchor_->motion)
        steps = anchor_->motion->stepsTo(steps);
    VectorXd step = VectorXd::Zero(anchor_->space.count);
    for (size_t i = 0; i < variable_.size(); i++)
    {
        const ParameterBlock& block = problem_.blocks()[variable_[i]];
        auto own = step.segment(anchor_->space.first[variable_[i]], anchor_->space.columnsOf(variable_[i]));
        if (isPose(i))
            own = steps[block.index];
        else
            own = transposeTimesVector(anchor_->space.bases[variable_[i]], block.values - anchor_->values[i]);
    }
    return step;
}

void ReducedCost::predictInner()
{
    const VectorXd step = stepFromAnchor();
    VectorXd inner = anchor_->inner;
    int at = 0;
    for (int i = 0; i < (int)anchor_->information.inner.size(); i++)
    {
        const InnerBlock& block = anchor_->information.inner[i];
        const int size = (int)block.byOuter.rows();
        VectorXd own(block.columns.size());
        for (size_t k = 0; k < block.columns.size(); k++)
            own[k] = step[block.columns[k]];
        const VectorXd change = timesVector(block.byOuter, own);
        if (anchor_->motion)
            anchor_->motion->movePoints(problem_, i, change, inner.segment(at, size));
        else
            inner.segment(at, size) += change;
        at += size;
    }
    setInnerValues(problem_, inner);
}

bool ReducedCost::optimize()
{
    if (!move() && isCurrent_)
        return true;
    isAnchor_ = false;
    if (anchor_)
        predictInner();
    isCurrent_ = optimizeInner(problem_, squaredError_);
    if (!isCurrent_ && anchor_)
    {
        setInnerValues(problem_, anchor_->inner);       // the prediction may have gone too far
        isCurrent_ = optimizeInner(problem_, squaredError_);
    }
    return isCurrent_;
}

bool ReducedCost::linearize()
{
    if (!optimize())
        return false;
    if (isAnchor_)
        return true;
    if (anchor_)                    // what it predicts is used up, and as large as all else together
        std::vector<InnerBlock>().swap(anchor_->information.inner);
    std::unique_ptr<Anchor> anchor(new Anchor{ {}, nullptr, FreeSpace(problem_, false), innerValues(problem_), squaredError_,
                                               informationOf(problem_, false, false) });
    if (!anchor->information.isFinite())
        return false;
    for (int block : variable_)
        anchor->values.push_back(problem_.blocks()[block].values);
    if (problem_.hasScene())
        anchor->motion.reset(new ViewMotion(problem_, *graph_));
    anchor_ = std::move(anchor);
    isAnchor_ = true;
    hasRoot_ = !problem_.hasScene();
    return true;
}

const Information& ReducedCost::rootedInformation()
{
    if (!hasRoot_)
        findRoot(anchor_->information);
    hasRoot_ = true;
    return anchor_->information;
}

void ReducedCost::PrepareForEvaluation(bool withJacobians, bool)
{
    isLinear_ = withJacobians;
    isPossible_ = withJacobians ? linearize() : optimize();
    if (withJacobians && isPossible_)
        rootedInformation();
}

//! Of a pose itself and those that are eliminated after it, and of the cameras; or of these alone.
std::vector<int> ReducedCost::blocksOf(int group) const
{
    const BlockCholesky& poses = information().poses.factor;
    std::vector<int> blocks;
    for (int i = 0; i < cameras_; i++)
        blocks.push_back(i);
    if (group < poses.count())
    {
        blocks.push_back(cameras_ + poses.blockAt(group));
        for (int place : poses.column(group).rows)
            blocks.push_back(cameras_ + poses.blockAt(place));
    }
    if (blocks.empty())
        blocks.push_back(0);        // Ceres has no residuals of nothing
    return blocks;
}

//! The group's rows of the root.
RowMajorMatrix ReducedCost::rootOf(int group, int variable) const
{
    const FreeSpace& space = anchor_->space;
    const Information& root = information();
    const int block = variable_[variable], first = space.first[block], size = space.columnsOf(block);
    const bool isOfPose = group < root.poses.factor.count();
    if (!isOfPose && variable < cameras_)
        return root.root.middleCols(first, size);
    if (!isOfPose)
        return RowMajorMatrix::Zero(root.root.rows(), size);
    const BlockCholesky& poses = root.poses.factor;
    if (variable < cameras_)
        return root.poses.byCameras.block(BlockCholesky::SIZE*poses.blockAt(group), first, BlockCholesky::SIZE, size);
    const BlockCholesky::Column& column = poses.column(group);
    const int place = poses.at(variable - cameras_);
    if (place == group)
        return column.diagonal.transpose();
    return column.blocks[std::lower_bound(column.rows.begin(), column.rows.end(), place) - column.rows.begin()].transpose();
}

//! Those of the cameras' group have what no step takes away, too.
VectorXd ReducedCost::residualsOf(int group) const
{
    const Information& all = information();
    const BlockCholesky& poses = all.poses.factor;
    const int SIZE = BlockCholesky::SIZE;
    VectorXd residuals = VectorXd::Zero(group < poses.count() ? SIZE : all.residual.size() + 1);
    if (group < poses.count())
    {
        if (isLinear_)
            residuals = all.poses.residual.segment<SIZE>(SIZE*poses.blockAt(group));
        return residuals;
    }
    if (isLinear_)
        residuals.head(all.residual.size()) = all.residual;
    const double explained = isLinear_ ? all.residual.squaredNorm() + all.poses.residual.squaredNorm() : 0;
    residuals.tail<1>()[0] = std::sqrt(std::max(squaredError_ - explained, 0.));
    return residuals;
}

ReducedCost::Group::Group(const ReducedCost& cost, int index) : cost_(cost), index_(index), blocks_(cost.blocksOf(index))
{
    for (int block : blocks_)
        mutable_parameter_block_sizes()->push_back((int)cost.problem_.blocks()[cost.variable_[block]].values.size());
    set_num_residuals((int)cost.residualsOf(index).size());
}

bool ReducedCost::Group::Evaluate(double const* const*, double* residuals, double** jacobians) const
{
    if (!cost_.isPossible_)
        return false;
    Eigen::Map<VectorXd>(residuals, num_residuals()) = cost_.residualsOf(index_);
    for (size_t i = 0; i < blocks_.size() && jacobians; i++)
    {
        if (!jacobians[i])
            continue;
        const RowMajorMatrix root = cost_.rootOf(index_, blocks_[i]);
        const int size = parameter_block_sizes()[i];
        Eigen::Map<RowMajorMatrix> J(jacobians[i], num_residuals(), size);
        J.bottomRows(num_residuals() - root.rows()).setZero();
        if (root.size() > 0)        // Eigen has no products of nothing
            J.topRows(root.rows()) = timesTranspose(root, cost_.anchor_->space.bases[cost_.variable_[blocks_[i]]]);
    }
    return true;
}

}} // namespace
