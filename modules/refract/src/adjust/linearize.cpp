// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/linearize.hpp"
#include "math/dense.hpp"
#include <numeric>

namespace cv { namespace refract {

FreeSpace::FreeSpace(const Problem& problem, bool withHeld) : count(0), cameras_(0)
{
    for (int i = 0; i < problem.outerCount(); i++)
    {
        const ParameterBlock& block = problem.blocks()[i];
        const bool isUnused = block.kind == ParameterBlock::POSE && !problem.isAdjusted(block.index);
        bases.push_back(isUnused ? Eigen::MatrixXd(block.values.size(), 0) : block.tangentBasis(withHeld));
        first.push_back(count);
        count += (int)bases.back().cols();
        cameras_ = block.kind == ParameterBlock::POSE ? cameras_ : count;
    }
}

static void setToNothing(Problem::Derivatives& d)
{
    d.residuals.setConstant(std::numeric_limits<double>::quiet_NaN());
    d.byPose.setZero();
    for (RowMajorMatrix& byBlock : d.byBlock)
        byBlock.setZero();
}

ImageRows::ImageRows(const Problem& problem, const FreeSpace& space, int i, const std::vector<double>& rootWeights)
{
    const Image& image = problem.images()[i];
    Problem::Derivatives d;
    if (!problem.evaluate(image, rootWeights, Problem::ALL, d))     // an image at its border may have no derivative: who asks sees NaN
        setToNothing(d);
    residuals = d.residuals;
    std::vector<int> blocks = problem.blocksOf(image);
    if (problem.hasScene())
    {
        inner = problem.byScenePoint(image, d.byPose);
        blocks.push_back(problem.poseBlock(image.view));
        d.byBlock.push_back(d.byPose);
    }
    else if (problem.isAdjusted(image.view))
        inner = d.byPose;
    else
        inner = RowMajorMatrix::Zero(d.byPose.rows(), 6);
    for (int block : blocks)
        for (int j = 0; j < space.columnsOf(block); j++)
            columns.push_back(space.first[block] + j);
    outer.resize(residuals.size(), columns.size());
    int column = 0;
    for (size_t b = 0; b < blocks.size(); b++)
    {
        const int own = space.columnsOf(blocks[b]);
        if (own > 0)
            outer.middleCols(column, own) = product(d.byBlock[b], space.bases[blocks[b]]);
        column += own;
    }
}

//! @param rootWeights in place of the images' own; null: their own
static void makeRows(const Problem& problem, const FreeSpace& space, const std::vector<int>& images,
                     const std::vector<std::vector<double> >* rootWeights, std::vector<std::unique_ptr<ImageRows> >& rows)
{
    parallel_for_(Range(0, (int)images.size()), [&](const Range& range)
    {
        for (int k = range.start; k < range.end; k++)
        {
            const int i = images[k];
            rows[i].reset(new ImageRows(problem, space, i, rootWeights ? (*rootWeights)[i] : problem.images()[i].rootWeights));
        }
    });
}

std::vector<ImageRows> linearize(const Problem& problem, const FreeSpace& space)
{
    std::vector<std::unique_ptr<ImageRows> > rows(problem.images().size());
    std::vector<int> images(rows.size());
    std::iota(images.begin(), images.end(), 0);
    makeRows(problem, space, images, nullptr, rows);
    std::vector<ImageRows> all;
    all.reserve(rows.size());
    for (std::unique_ptr<ImageRows>& image : rows)
        all.push_back(std::move(*image));
    return all;
}

PassingRows::PassingRows(const Problem& problem, const FreeSpace& space, const std::vector<std::vector<double> >* rootWeights)
    : problem_(problem), space_(space), rootWeights_(rootWeights), first_(problem.images().size(), std::numeric_limits<int>::max()),
      last_(problem.images().size(), -1), rows_(problem.images().size())
{
    for (int cluster = 0; problem.hasScene() && cluster < (int)problem.scene().clusters().size(); cluster++)
        for (const Observation& o : problem.observationsOf(cluster))
        {
            first_[o.image] = std::min(first_[o.image], cluster);
            last_[o.image] = cluster;
        }
    for (size_t i = 0; i < rows_.size() && !problem.hasScene(); i++)
        first_[i] = last_[i] = problem.images()[i].view;
}

std::vector<int> PassingRows::moveTo(int begin, int end)
{
    std::vector<int> added;
    for (int i = 0; i < (int)rows_.size(); i++)
    {
        if (last_[i] < begin)
            rows_[i].reset();
        else if (first_[i] < end && !rows_[i])
            added.push_back(i);
    }
    makeRows(problem_, space_, added, rootWeights_, rows_);
    return added;
}

Eigen::MatrixXd rigPriorRows(const Problem& problem, const FreeSpace& space)
{
    const Eigen::MatrixXd byValues = problem.rigPriorRows();
    Eigen::MatrixXd rows(byValues.rows(), 0);
    int first = 0;
    for (int block = 0; block < problem.cameraBlockCount(); block++)
    {
        const Eigen::MatrixXd& basis = space.bases[block];
        rows.conservativeResize(Eigen::NoChange, rows.cols() + basis.cols());
        if (basis.cols() > 0)       // Eigen has no products of nothing
            rows.rightCols(basis.cols()) = product(byValues.middleCols(first, basis.rows()), basis);
        first += (int)basis.rows();
    }
    return rows;
}

}} // namespace
