// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/distributions.hpp"
#include "scenes.hpp"

using namespace tools;

TEST_CASE("The tail of F agrees with its tables", "[f_distribution]")
{
    CHECK(upperTailF(1, 10, 4.1028) == Approx(0.05).epsilon(1e-4));
    CHECK(upperTailF(2, 20, 2.8661) == Approx(0.05).epsilon(1e-4));
    CHECK(upperTailF(5, 30, 2.9791) == Approx(0.01).epsilon(1e-3));
    CHECK(upperTailF(1, 1e8, 9.2103/2) == Approx(0.01).epsilon(1e-4));       // chi-square
    CHECK(upperTailF(500, 2000, 1.) == Approx(0.5).epsilon(0.05));
    CHECK(upperTailF(3, 10, 0.) == 1.);
    CHECK(upperTailF(600, 1e8, 1e6) == 0.);
    for (double v : {3., 40., 2744., 1e8})
        for (double p : {0.5, 0.01, 1e-9})
        {
            CHECK(upperTailF(1, v, quantileF(2, v, p)) == Approx(p).epsilon(1e-6));
            CHECK(upperTailAnyF(3, v, quantileF(3, v, p)) == Approx(p).epsilon(1e-6));
        }
}

TEST_CASE("The tail of F with an odd number of degrees of freedom agrees with its tables", "[f_distribution]")
{
    CHECK(upperTailAnyF(4, 20, 2.8661) == Approx(0.05).epsilon(1e-4));
    CHECK(upperTailAnyF(1, 20, 4.3512) == Approx(0.05).epsilon(1e-3));
    CHECK(upperTailAnyF(1, 60, 7.0771) == Approx(0.01).epsilon(1e-3));
    CHECK(upperTailAnyF(3, 30, 4.5097) == Approx(0.01).epsilon(1e-3));
    CHECK(upperTailAnyF(5, 40, 2.4495) == Approx(0.05).epsilon(1e-3));
    CHECK(upperTailAnyF(1, 1e8, 6.6349) == Approx(0.01).epsilon(1e-4));       // chi-square
    CHECK(upperTailAnyF(3, 1e8, 11.3449/3) == Approx(0.01).epsilon(1e-4));
    CHECK(upperTailAnyF(3, 30, 0.) == 1.);
}

TEST_CASE("The tail of the noncentral F agrees with a simulation", "[f_distribution]")
{
    scenes::Random random(3001);
    std::cout << "seed " << scenes::seed() << '\n';
    const int v = 20, trials = 40000;
    const double lambda = 6., x = 3.;
    int above = 0, aboveOfThree = 0;
    for (int i = 0; i < trials; i++)
    {
        double chi = 0.;
        for (int k = 0; k < v; k++)
            chi += std::pow(random.normal(1), 2);
        const double a = random.normal(1) + std::sqrt(lambda), b = random.normal(1);
        above += 0.5*(a*a + b*b) > x*chi/v;
        aboveOfThree += (a*a + b*b + std::pow(random.normal(1), 2))/3. > x*chi/v;
    }
    CHECK(upperTailNoncentralF(2, v, lambda, x) == Approx((double)above/trials).margin(0.01));
    CHECK(upperTailNoncentralF(3, v, lambda, x) == Approx((double)aboveOfThree/trials).margin(0.01));
    CHECK(upperTailNoncentralF(2, v, 0., x) == Approx(upperTailF(1, v, x)));
    CHECK(upperTailNoncentralF(2, 1e8, 1e4, x) == Approx(1.));
}
