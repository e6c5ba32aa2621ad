// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// How long a small vector is of which one axis may be known much worse than another.
#include "measure/eigen_matrix.hpp"
#include "../normal_draw.hpp"
#include "scenes.hpp"
#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>

using namespace tools;

TEST_CASE("A vector's length is within what is stated of it, from zero to long, known evenly or not", "[vector_length]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const int DRAWS = 2000;
    scenes::Random random(3100);
    for (const int count : {2, 3})
        for (const double better : {1., 3., 10.})
            for (const double length : {0.3, 1., 2., 4., 8., 30.})
                for (const double angle : {0., 0.25*CV_PI, 0.5*CV_PI})
                {
                    VectorXd std = VectorXd::Constant(count, 1./better), truth = VectorXd::Zero(count);
                    std[0] = 1.;
                    truth.head(2) << length*std::cos(angle), length*std::sin(angle);
                    int within = 0;
                    for (int i = 0; i < DRAWS; i++)
                    {
                        VectorXd estimate = truth;
                        for (int k = 0; k < count; k++)
                            estimate[k] += random.normal(std[k]);
                        const VectorLength told = lengthOf(estimate, MatrixXd(std.cwiseAbs2().asDiagonal()));
                        within += std::abs(told.value - length) <= 1.96*told.std;
                    }
                    INFO(count << " axes, " << better << " times, length " << length << ", " << angle);
                    // In three dimensions no length of noise alone is near 0.3.
                    CHECK(within >= (length < 1. ? 0.8 : 0.89)*DRAWS);
                    if (length >= 8. && (angle == 0. || better == 1.))
                        CHECK(within <= 0.98*DRAWS);
                }
}

TEST_CASE("The length of no vector is as uncertain as all of it, and one number has its sign", "[vector_length]")
{
    const VectorLength none = lengthOf(VectorXd::Zero(2), MatrixXd(VectorXd::Constant(2, 4.).asDiagonal()));
    CHECK(none.value == 0.);
    CHECK(none.std == Approx(std::sqrt(8.)));
    const VectorLength one = lengthOf(VectorXd::Constant(1, -3.), MatrixXd::Constant(1, 1, 0.25));
    CHECK(one.value == -3.);
    CHECK(one.std == 0.5);
}
