// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The sparse matrix of a scene's poses.
#include "adjust/block_cholesky.hpp"
#include "bundle_scenes.hpp"
#include "math/dense.hpp"

using namespace cv::refract;
using namespace scenes;
using Eigen::MatrixXd;

TEST_CASE("A sparse matrix of blocks has the factor and the inverse of the dense one", "[sparse]")
{
    CAPTURE(seed());
    const int SIZE = BlockCholesky::SIZE, count = 40;
    Random random(47);
    BlockGraph graph(count);
    MatrixXd dense = MatrixXd::Zero(SIZE*count, SIZE*count);
    for (int a = 0; a < count; a++)
        for (int b : { a + 1, a + 3, (7*a + 5) % count })
        {
            if (b >= count || b == a)
                continue;
            if (std::find(graph[a].begin(), graph[a].end(), b) == graph[a].end())
            {
                graph[a].push_back(b);
                graph[b].push_back(a);
            }
            MatrixXd rows = MatrixXd::Zero(SIZE, SIZE*count);
            for (int r = 0; r < SIZE; r++)
                for (int c = 0; c < SIZE; c++)
                {
                    rows(r, SIZE*a + c) = random.normal(1);
                    rows(r, SIZE*b + c) = random.normal(1);
                }
            dense += rows.transpose()*rows;
        }
    const auto fill = [&](BlockCholesky& sparse)
    {
        for (int k = 0; k < count; k++)
        {
            BlockCholesky::Column& column = sparse.column(k);
            const int block = SIZE*sparse.blockAt(k);
            column.diagonal = dense.block(block, block, SIZE, SIZE);
            for (size_t i = 0; i < column.rows.size(); i++)
                column.blocks[i] = dense.block(SIZE*sparse.blockAt(column.rows[i]), block, SIZE, SIZE);
        }
        sparse.factor(sparse.diagonal().cwiseSqrt(), 1e-12);
    };
    BlockCholesky sparse(graph);
    fill(sparse);
    CHECK(sparse.lost() < 0);
    const MatrixXd whole = inverse(dense);
    MatrixXd X = MatrixXd::Identity(SIZE*count, SIZE*count);
    sparse.solveL(X);
    CHECK((X.transpose()*X - whole).norm() < 1e-9*whole.norm());
    sparse.solveTranspose(X);
    CHECK((X - whole).norm() < 1e-9*whole.norm());
    const BlockInverse inverted(sparse);
    for (int a = 0; a < count; a++)
    {
        CHECK((inverted(a, a) - whole.block(SIZE*a, SIZE*a, SIZE, SIZE)).norm() < 1e-9*whole.norm());
        for (int b : graph[a])
            CHECK((inverted(a, b) - whole.block(SIZE*a, SIZE*b, SIZE, SIZE)).norm() < 1e-9*whole.norm());
    }
    // A block whose last coordinate nothing tells.
    dense.row(SIZE*9 + 5).setZero();
    dense.col(SIZE*9 + 5).setZero();
    BlockCholesky singular(graph);
    fill(singular);
    CHECK(singular.lost() == 9);
    MatrixXd b = dense*MatrixXd::Ones(SIZE*count, 1);
    singular.solveL(b);
    singular.solveTranspose(b);
    CHECK(b(SIZE*9 + 5) == 0);
    CHECK(std::abs(b(SIZE*20) - 1) < 1e-8);
}
