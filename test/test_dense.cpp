// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "math/dense.hpp"
#include "scenes.hpp"

using namespace cv::refract;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

//! Of n numbers, deviations from 1e-6 to 1e6, of which the directions that are known span a space of the rank.
MatrixXd covarianceOf(int n, int rank, scenes::Random& random)
{
    MatrixXd root(n, rank);
    for (int i = 0; i < n; i++)
        for (int k = 0; k < rank; k++)
            root(i, k) = std::pow(10., 12.*i/(n - 1) - 6)*random.normal(1.);
    return timesTranspose(root, root);
}

MatrixXd drawn(scenes::Random& random, int rows, int columns)
{
    return MatrixXd::NullaryExpr(rows, columns, [&](Eigen::Index, Eigen::Index) { return random.normal(1.); });
}

} // namespace

TEST_CASE("Roots of a covariance and of its inverse, of parameters of all sizes", "[dense]")
{
    const int n = 7, rank = GENERATE(1, 4, 7);
    scenes::Random random(40 + rank);
    const MatrixXd C = covarianceOf(n, rank, random);
    const CorrelationSpectrum spectrum(C);
    REQUIRE(spectrum.rank(1e-12) == rank);
    const MatrixXd S = spectrum.root(rank), T = spectrum.inverseRoot(rank);
    const VectorXd D = spectrum.inverseDeviations;
    CHECK((D.asDiagonal()*(timesTranspose(S, S) - C)*D.asDiagonal()).cwiseAbs().maxCoeff() < 1e-12);
    CHECK((transposeTimes(T, S) - MatrixXd::Identity(rank, rank)).cwiseAbs().maxCoeff() < 1e-9);
    if (rank == n)
        CHECK((product(timesTranspose(T, T), C) - MatrixXd::Identity(n, n)).cwiseQuotient(
            spectrum.inverseDeviations*spectrum.deviations.transpose()).cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("What has no variance has no part in the root of a covariance", "[dense]")
{
    scenes::Random random(41);
    MatrixXd C = covarianceOf(5, 5, random);
    C.row(2).setZero();
    C.col(2).setZero();
    const CorrelationSpectrum spectrum(C);
    REQUIRE(spectrum.rank(1e-12) == 4);
    CHECK(spectrum.root(4).row(2).isZero(0.));
    CHECK(spectrum.inverseRoot(4).row(2).isZero(0.));
    const CorrelationSpectrum nothing(MatrixXd::Zero(3, 3));
    CHECK(nothing.rank() == 0);
    CHECK(nothing.deviations.isZero(0.));
}

// The four conditions of Moore and Penrose, of matrices of any shape and rank.
TEST_CASE("A pseudo-inverse is that of Moore and Penrose", "[dense]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    scenes::Random numbers(scenes::seed());
    const struct { int rows, columns, rank; } shapes[] = {{5, 5, 5}, {9, 4, 4}, {4, 9, 4}, {9, 6, 3}, {6, 9, 2}, {3, 3, 0}, {1, 4, 1},
                                                          {4, 1, 1}};
    for (const auto& [rows, columns, rank] : shapes)
    {
        CAPTURE(rows, columns, rank);
        const MatrixXd A = product(drawn(numbers, rows, rank), drawn(numbers, rank, columns));
        const MatrixXd X = pseudoInverse(A, 1e-10), AX = A*X, XA = X*A;
        REQUIRE(X.rows() == columns);
        REQUIRE(X.cols() == rows);
        CHECK((AX*A - A).norm() <= 1e-12*A.norm());
        CHECK((XA*X - X).norm() <= 1e-12*X.norm());
        CHECK((AX - AX.transpose()).norm() < 1e-12);
        CHECK((XA - XA.transpose()).norm() < 1e-12);
    }
}
