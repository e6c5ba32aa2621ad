// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/reduced_cost.hpp"
#include "adjust/inner.hpp"

namespace cv { namespace refract {

using Eigen::VectorXd;

ReducedCost::ReducedCost(Problem& problem) : problem_(problem), isCurrent_(false), isAnchor_(false), squaredError_(0)
{
    const FreeSpace space(problem, false);
    count_ = space.count;
    for (int block = 0; block < problem.outerCount(); block++)
        if (space.columnsOf(block) > 0)
        {
            variable_.push_back(block);
            mutable_parameter_block_sizes()->push_back((int)problem.blocks()[block].values.size());
        }
    set_num_residuals(count_ + 1);
}

//! False if it is there already.
bool ReducedCost::moveTo(double const* const* parameters) const
{
    bool hasMoved = false;
    for (size_t i = 0; i < variable_.size(); i++)
    {
        Eigen::Map<VectorXd>& values = problem_.blocks()[variable_[i]].values;
        const Eigen::Map<const VectorXd> wanted(parameters[i], values.size());
        hasMoved = hasMoved || values != wanted;
        values = wanted;
    }
    problem_.updateCameras();
    return hasMoved;
}

void ReducedCost::predictInner() const
{
    VectorXd change = VectorXd::Zero(count_);
    for (size_t i = 0; i < variable_.size(); i++)
    {
        const int block = variable_[i], own = anchor_->space.columnsOf(block);
        change.segment(anchor_->space.first[block], own) =
            transposeTimesVector(anchor_->space.bases[block], problem_.blocks()[block].values - anchor_->values[i]);
    }
    VectorXd inner = anchor_->inner;
    int at = 0;
    for (const InnerBlock& block : anchor_->information.inner)
    {
        const int size = (int)block.byOuter.rows();
        VectorXd own(block.columns.size());
        for (size_t k = 0; k < block.columns.size(); k++)
            own[k] = change[block.columns[k]];
        inner.segment(at, size) += timesVector(block.byOuter, own);
        at += size;
    }
    setInnerValues(problem_, inner);
}

bool ReducedCost::optimizeAt(double const* const* parameters) const
{
    if (!moveTo(parameters) && isCurrent_)
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

bool ReducedCost::linearizeAt(double const* const* parameters) const
{
    if (!optimizeAt(parameters))
        return false;
    if (isAnchor_)
        return true;
    std::unique_ptr<Anchor> anchor(new Anchor{ {}, FreeSpace(problem_, false), innerValues(problem_),
                                               informationOf(problem_, false) });
    if (!anchor->information.root.allFinite() || !anchor->information.residual.allFinite())
        return false;
    for (int block : variable_)
        anchor->values.push_back(problem_.blocks()[block].values);
    anchor_ = std::move(anchor);
    isAnchor_ = true;
    return true;
}

bool ReducedCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const
{
    if (jacobians ? !linearizeAt(parameters) : !optimizeAt(parameters))
        return false;
    Eigen::Map<VectorXd> r(residuals, count_ + 1);
    r.setZero();
    r[count_] = std::sqrt(squaredError_);
    if (!jacobians)
        return true;
    const Information& information = anchor_->information;
    r.head(count_) = information.residual;
    r[count_] = std::sqrt(std::max(squaredError_ - information.residual.squaredNorm(), 0.));
    for (size_t i = 0; i < variable_.size(); i++)
    {
        if (!jacobians[i])
            continue;
        const int block = variable_[i];
        const Eigen::MatrixXd& basis = anchor_->space.bases[block];
        Eigen::Map<RowMajorMatrix> J(jacobians[i], count_ + 1, problem_.blocks()[block].values.size());
        J.topRows(count_) = timesTranspose(information.root.middleCols(anchor_->space.first[block], basis.cols()), basis);
        J.bottomRows<1>().setZero();
    }
    return true;
}

}} // namespace
