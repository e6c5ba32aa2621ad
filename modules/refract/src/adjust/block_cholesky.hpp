// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_BLOCK_CHOLESKY_HPP
#define OPENCV_REFRACT_BLOCK_CHOLESKY_HPP

#include "precomp.hpp"
#include <Eigen/Core>

namespace cv { namespace refract {

//! Which blocks of a symmetric matrix may differ from 0: a list of the others of each, in any order.
typedef std::vector<std::vector<int> > BlockGraph;

/** A symmetric matrix of 6 x 6 blocks, most of which are 0, and its factor L, L L^T = the matrix, which takes its place. Blocks are
eliminated in the order of least degree (AMD), so that few others are filled; where the blocks are views of a strip, time and
memory grow with their number. Vectors and matrices beside it have the blocks in the caller's order. */
class BlockCholesky
{
public:
    static const int SIZE = 6;
    typedef Eigen::Matrix<double, SIZE, SIZE> Block;

    //! A matrix of zeros. @param graph also symmetric: a is in the list of b if b is in that of a
    explicit BlockCholesky(const BlockGraph& graph = BlockGraph());
    int count() const { return (int)order_.size(); }        //!< of blocks
    int at(int block) const { return place_[block]; }       //!< when it is eliminated
    int blockAt(int place) const { return order_[place]; }

    //! Of the lower half, in the order of elimination: a column's diagonal, and what is below it. Rows ascend.
    struct Column
    {
        Block diagonal;
        std::vector<int> rows;                              //!< places
        std::vector<Block, Eigen::aligned_allocator<Block> > blocks;
        EIGEN_MAKE_ALIGNED_OPERATOR_NEW
    };
    const Column& column(int place) const { return columns_[place]; }
    Column& column(int place) { return columns_[place]; }

    size_t bytes() const;
    //! Of each row.
    Eigen::VectorXd diagonal() const;
    /** Factors. What is left of a row's diagonal below this part of its squared effect is rounding: its row and column are 0.
    @param effect of each row, to which it is scaled */
    void factor(const Eigen::VectorXd& effect, double rounding);
    //! The first block to be eliminated that has such a row; -1: none.
    int lost() const { return lost_; }
    void solveL(Eigen::Ref<Eigen::MatrixXd> X) const;           //!< X = L^-1 X
    void solveTranspose(Eigen::Ref<Eigen::MatrixXd> X) const;   //!< X = L^-T X

private:
    void findFill(const BlockGraph& graph);
    void scale(const Eigen::VectorXd& rows, bool areColumnsToo);
    void subtractColumn(int place);

    std::vector<int> order_, place_;
    std::vector<Column, Eigen::aligned_allocator<Column> > columns_;
    int lost_ = -1;
};

/** The inverse of a factored matrix, where its factor is not 0: of other blocks no use is made. By the equations of Takahashi (Erisman
and Tinney, On computing certain elements of the inverse of a sparse matrix, 1975). */
class BlockInverse
{
public:
    typedef BlockCholesky::Block Block;
    BlockInverse() {}
    explicit BlockInverse(BlockCholesky factor);
    //! Throws where the factor is 0.
    Block operator()(int a, int b) const;

private:
    Block atPlaces(int row, int column) const;
    BlockCholesky inverse_;
};

}} // namespace

#endif // OPENCV_REFRACT_BLOCK_CHOLESKY_HPP
