// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What no unknown of a view explains, and the best unknowns, against decompositions of the whole.
#include "measure/view_observations.hpp"
#include "scenes.hpp"
#include <catch2/catch.hpp>
#include <iostream>

using namespace tools;
using namespace cv::refract;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

MatrixXd drawn(scenes::Random& random, int rows, int columns)
{
    MatrixXd m(rows, columns);
    for (double& value : m.reshaped())
        value = random.normal(1);
    return m;
}

//! Derivatives by all unknowns: of a scene each point has three columns of its own.
MatrixXd byAll(const ViewObservations& observed, const MatrixXd& byPose)
{
    if (!observed.isScene)
        return byPose;
    MatrixXd all = MatrixXd::Zero(byPose.rows(), observed.unknowns());
    int row = 0;
    for (const ImageOfView& image : observed.images)
        for (int point : image.points)
        {
            all.block(row, 3*point, 2, 3) = byPose.block(row, 3, 2, 3);
            row += 2;
        }
    return all;
}

} // namespace

TEST_CASE("What the unknowns of a view explain is least squares, of a board and of a scene", "[tools][view_observations]")
{
    scenes::Random random(4601);
    std::cout << "seed " << scenes::seed() << '\n';
    for (const bool isScene : { false, true })
    {
        ViewObservations observed;
        observed.isScene = isScene;
        observed.objectPoints.resize(6);
        observed.images = { { 0, true, { 0, 1, 2, 3, 4, 5 } }, { 1, true, { 0, 2, 3, 4, 5 } }, { 2, true, { 1, 2, 4 } } };
        const int rows = 2*(6 + 5 + 3);
        const MatrixXd byPose = drawn(random, rows, 6), others = drawn(random, rows, 7), all = byAll(observed, byPose);
        const UnknownsOfView unknowns(observed, byPose);
        const PivotedQR qr(all);
        const MatrixXd rest = others - product(all, qr.solve(others)), projected = unknowns.projectedOut(others);
        CHECK(projected.rows() == rows - observed.unknowns());
        CHECK((transposeTimes(projected, projected) - transposeTimes(rest, rest)).norm() < 1e-10*others.squaredNorm());
        CHECK(unknowns.projectedOut(all).norm() < 1e-12*all.norm());
        const VectorXd residual = others.col(0);
        CHECK((unknowns.solve(residual) - qr.solve(residual)).norm() < 1e-9*qr.solve(residual).norm());
    }
}

TEST_CASE("A coordinate of a point that moves no pixel stays where it is", "[tools][view_observations]")
{
    scenes::Random random(4602);
    std::cout << "seed " << scenes::seed() << '\n';
    ViewObservations observed;
    observed.isScene = true;
    observed.objectPoints.resize(1);
    observed.images = { { 0, true, { 0 } }, { 1, true, { 0 } } };
    MatrixXd byPose = drawn(random, 4, 6);
    const double scale = byPose.norm();
    for (const double nothing : { 0., 1e-17*scale })
    {
        byPose.col(5).setConstant(nothing);
        const UnknownsOfView unknowns(observed, byPose);
        const VectorXd residual = drawn(random, 4, 1), step = unknowns.solve(residual);
        CHECK(step.allFinite());
        CHECK(unknowns.projectedOut(residual).allFinite());
        CHECK(step[2] == 0);
        CHECK((step.head(2) - PivotedQR(byPose.middleCols(3, 2)).solve(residual)).norm() < 1e-10*step.norm());
    }
}
