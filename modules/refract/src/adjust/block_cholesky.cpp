// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/block_cholesky.hpp"
#include <Eigen/OrderingMethods>

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
typedef BlockCholesky::Block Block;
const int SIZE = BlockCholesky::SIZE;

// Fewer products than that are made sooner than another thread is there.
const int FEW = 24;

std::vector<int> orderOfLeastDegree(const BlockGraph& graph)
{
    const int count = (int)graph.size();
    std::vector<Eigen::Triplet<double> > entries;
    for (int i = 0; i < count; i++)
    {
        entries.push_back(Eigen::Triplet<double>(i, i, 1));
        for (int other : graph[i])
            entries.push_back(Eigen::Triplet<double>(i, other, 1));
    }
    Eigen::SparseMatrix<double> pattern(count, count);
    pattern.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    Eigen::AMDOrdering<int>()(pattern, order);
    return std::vector<int>(order.indices().data(), order.indices().data() + count);
}

//! A = L L^T. @return whether some element of the diagonal was lost
bool factorDiagonal(double rounding, Block& A)
{
    bool isLost = false;
    for (int k = 0; k < SIZE; k++)
    {
        const double left = A(k, k) - A.row(k).head(k).squaredNorm();
        const bool isZero = !(left > rounding);
        isLost = isLost || isZero;
        A(k, k) = isZero ? 0 : std::sqrt(left);
        for (int i = k + 1; i < SIZE; i++)
            A(i, k) = isZero ? 0 : (A(i, k) - A.row(i).head(k).dot(A.row(k).head(k)))/A(k, k);
        A.col(k).head(k).setZero();
    }
    return isLost;
}

double inverseOrZero(double value) { return value > 0 ? 1/value : 0; }

//! X L^-T, of a diagonal block L.
Block timesInverseTranspose(const Block& L, const Block& X)
{
    Block Y;
    for (int k = 0; k < SIZE; k++)
    {
        Eigen::Matrix<double, SIZE, 1> column = X.col(k);
        for (int m = 0; m < k; m++)
            column -= L(k, m)*Y.col(m);
        Y.col(k) = inverseOrZero(L(k, k))*column;
    }
    return Y;
}

Block inverseOf(const Block& L) { return timesInverseTranspose(L, Block::Identity()).transpose(); }

} // namespace

BlockCholesky::BlockCholesky(const BlockGraph& graph)
{
    if (graph.empty())
        return;
    order_ = orderOfLeastDegree(graph);
    place_.resize(order_.size());
    for (int k = 0; k < count(); k++)
        place_[order_[k]] = k;
    columns_.resize(order_.size());
    findFill(graph);
}

//! A column has the rows of the graph, and those of the columns whose first row it is.
void BlockCholesky::findFill(const BlockGraph& graph)
{
    for (int k = 0; k < count(); k++)
    {
        std::vector<int>& rows = columns_[k].rows;      // those of earlier columns are there
        for (int other : graph[order_[k]])
            if (place_[other] > k)
                rows.push_back(place_[other]);
        std::sort(rows.begin(), rows.end());
        rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
        if (!rows.empty())
        {
            std::vector<int>& parent = columns_[rows[0]].rows;
            parent.insert(parent.end(), rows.begin() + 1, rows.end());
        }
        columns_[k].diagonal.setZero();
        columns_[k].blocks.assign(rows.size(), Block::Zero());
    }
}

size_t BlockCholesky::bytes() const
{
    size_t blocks = columns_.size();
    for (const Column& column : columns_)
        blocks += column.rows.size();
    return blocks*(sizeof(Block) + sizeof(int));
}

VectorXd BlockCholesky::diagonal() const
{
    VectorXd all(SIZE*count());
    for (int k = 0; k < count(); k++)
        all.segment<SIZE>(SIZE*order_[k]) = columns_[k].diagonal.diagonal();
    return all;
}

void BlockCholesky::scale(const VectorXd& rows, bool areColumnsToo)
{
    for (int k = 0; k < count(); k++)
    {
        const auto ofRow = [&](int place) { return rows.segment<SIZE>(SIZE*order_[place]).asDiagonal(); };
        Column& column = columns_[k];
        column.diagonal = (ofRow(k)*column.diagonal).eval();
        if (areColumnsToo)
            column.diagonal = (column.diagonal*ofRow(k)).eval();
        for (size_t i = 0; i < column.rows.size(); i++)
        {
            column.blocks[i] = (ofRow(column.rows[i])*column.blocks[i]).eval();
            if (areColumnsToo)
                column.blocks[i] = (column.blocks[i]*ofRow(k)).eval();
        }
    }
}

//! From all columns to its right. The rows of each of these contain those of this one.
void BlockCholesky::subtractColumn(int place)
{
    const Column& own = columns_[place];
    const int count = (int)own.rows.size();
    const auto subtract = [&](const Range& range)
    {
        for (int b = range.start; b < range.end; b++)
        {
            Column& column = columns_[own.rows[b]];
            column.diagonal.noalias() -= own.blocks[b].lazyProduct(own.blocks[b].transpose());
            size_t row = 0;
            for (int a = b + 1; a < count; a++, row++)
            {
                while (column.rows[row] != own.rows[a])
                    row++;
                column.blocks[row].noalias() -= own.blocks[a].lazyProduct(own.blocks[b].transpose());
            }
        }
    };
    if (count < FEW)
        subtract(Range(0, count));
    else
        parallel_for_(Range(0, count), subtract);
}

void BlockCholesky::factor(const VectorXd& effect, double rounding)
{
    scale(effect.unaryExpr([](double e) { return inverseOrZero(e); }), true);
    lost_ = -1;
    for (int k = 0; k < count(); k++)
    {
        Column& column = columns_[k];
        if (factorDiagonal(rounding, column.diagonal) && lost_ < 0)
            lost_ = order_[k];
        for (Block& block : column.blocks)
            block = timesInverseTranspose(column.diagonal, block);
        subtractColumn(k);
    }
    scale(effect, false);
}

void BlockCholesky::solveL(Eigen::Ref<MatrixXd> X) const
{
    for (int k = 0; k < count(); k++)
    {
        const Column& column = columns_[k];
        auto own = X.middleRows<SIZE>(SIZE*order_[k]);
        own = inverseOf(column.diagonal).lazyProduct(own).eval();
        for (size_t i = 0; i < column.rows.size(); i++)
            X.middleRows<SIZE>(SIZE*order_[column.rows[i]]).noalias() -= column.blocks[i].lazyProduct(own);
    }
}

void BlockCholesky::solveTranspose(Eigen::Ref<MatrixXd> X) const
{
    for (int k = count() - 1; k >= 0; k--)
    {
        const Column& column = columns_[k];
        auto own = X.middleRows<SIZE>(SIZE*order_[k]);
        for (size_t i = 0; i < column.rows.size(); i++)
            own.noalias() -= column.blocks[i].transpose().lazyProduct(X.middleRows<SIZE>(SIZE*order_[column.rows[i]]));
        own = inverseOf(column.diagonal).transpose().lazyProduct(own).eval();
    }
}

//! With Y = L below the diagonal, times the diagonal's inverse: Z = -Z' Y below it, D^-T D^-1 - Y^T Z on it; Z' is right of it.
BlockInverse::BlockInverse(BlockCholesky factor) : inverse_(std::move(factor))
{
    for (int k = inverse_.count() - 1; k >= 0; k--)
    {
        BlockCholesky::Column& column = inverse_.column(k);
        const int count = (int)column.rows.size();
        const Block D = inverseOf(column.diagonal);
        std::vector<Block, Eigen::aligned_allocator<Block> > Y(count);
        for (int i = 0; i < count; i++)
            Y[i] = column.blocks[i].lazyProduct(D);
        const auto multiply = [&](const Range& range)
        {
            for (int a = range.start; a < range.end; a++)
            {
                column.blocks[a].setZero();
                for (int b = 0; b < count; b++)
                    column.blocks[a].noalias() -= atPlaces(column.rows[a], column.rows[b]).lazyProduct(Y[b]);
            }
        };
        if (count < FEW)
            multiply(Range(0, count));
        else
            parallel_for_(Range(0, count), multiply);
        column.diagonal = D.transpose().lazyProduct(D);
        for (int i = 0; i < count; i++)
            column.diagonal.noalias() -= Y[i].transpose().lazyProduct(column.blocks[i]);
    }
}

Block BlockInverse::atPlaces(int row, int column) const
{
    if (row < column)
        return atPlaces(column, row).transpose();
    const BlockCholesky::Column& own = inverse_.column(column);
    if (row == column)
        return own.diagonal;
    const auto found = std::lower_bound(own.rows.begin(), own.rows.end(), row);
    CV_Assert(found != own.rows.end() && *found == row);
    return own.blocks[found - own.rows.begin()];
}

Block BlockInverse::operator()(int a, int b) const { return atPlaces(inverse_.at(a), inverse_.at(b)); }

}} // namespace
