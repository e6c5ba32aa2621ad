// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Coverage factors against the table of EA-4/02 M:2022 (table E.1) and exact values of Student's t.
#include "measure/distributions.hpp"
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace tools;

TEST_CASE("The coverage factor is that of EA-4/02", "[student_t]")
{
    const double INF = std::numeric_limits<double>::infinity();
    const struct { double dof, k; } table[] = {{1, 13.97}, {2, 4.53}, {3, 3.31}, {4, 2.87}, {5, 2.65}, {6, 2.52}, {7, 2.43}, {8, 2.37},
                                               {10, 2.28}, {20, 2.13}, {50, 2.05}, {INF, 2.00}};
    for (const auto& row : table)
    {
        CAPTURE(row.dof);
        CHECK(coverageFactor(row.dof) == Approx(row.k).margin(0.0051));
    }
    CHECK(coverageFactor(8.9) == coverageFactor(8.));       // GUM, G.4.1
    CHECK(coverageFactor(0.5) == INF);
    CHECK(coverageFactor(99999.) == Approx(coverageFactor(INF)).epsilon(1e-4));     // where one formula follows the other
    CHECK(withinStudentT(12.7062, 1) == Approx(0.95).epsilon(1e-6));
    CHECK(withinStudentT(2.7764, 4) == Approx(0.95).epsilon(1e-5));
    CHECK(withinStudentT(2.0423, 30) == Approx(0.95).epsilon(1e-4));
}

TEST_CASE("Welch and Satterthwaite: only the part that was estimated counts", "[student_t]")
{
    CHECK(effectiveDof(1., 1., 10.) == Approx(10.));
    CHECK(effectiveDof(2., 1., 10.) == Approx(40.));
    CHECK(effectiveDof(1., 0., 10.) == std::numeric_limits<double>::infinity());
}
