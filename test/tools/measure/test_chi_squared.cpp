// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/distributions.hpp"
#include "scenes.hpp"
#include <limits>

using namespace tools;

TEST_CASE("Tails of chi squared", "[distributions]")
{
    // R: pchisq(x, k, lower.tail = FALSE)
    CHECK(upperTailChiSquared(1, 3.841458820694124) == Approx(0.05).epsilon(1e-9));
    CHECK(upperTailChiSquared(2, 5.991464547107979) == Approx(0.05).epsilon(1e-9));
    CHECK(upperTailChiSquared(3, 7.814727903251179) == Approx(0.05).epsilon(1e-9));
    CHECK(upperTailChiSquared(6, 12.591587243743977) == Approx(0.05).epsilon(1e-9));
    CHECK(upperTailChiSquared(6, 0.) == 1.);
    CHECK(upperTailChiSquared(1, 36.) == Approx(1.973175290075e-9).epsilon(1e-6));
    // mpmath: log(gammainc(k/2, x/2, regularized=True)); beyond what a number holds, too
    for (const cv::Vec3d& known : std::vector<cv::Vec3d>{
            {1, 36.0, -20.0436217694148}, {1, 1600.0, -803.915294833194}, {2, 1500.0, -750.0}, {3, 2500.0, -1246.31336858694},
            {6, 40000.0, -19980.8860720755}, {24, 10.0, -0.00546801429217589}, {24, 5000.0, -2431.43339379212},
            {301, 1000000.0, -498640.720330905}, {3000, 3000.0, -0.700037990069293}, {3000, 9000.0, -1357.35081800321}})
    {
        CAPTURE(known[0], known[1]);
        CHECK(logUpperTailChiSquared((int)known[0], known[1]) == Approx(known[2]).epsilon(1e-9));
    }
}

TEST_CASE("The z-score of a chi squared is as rare", "[distributions]")
{
    // mpmath: the z of erfc(z/sqrt(2)) = gammainc(k/2, x/2, regularized=True)
    for (const cv::Vec3d& known : std::vector<cv::Vec3d>{
            {2, 1.0, 0.515031998812217}, {2, 40.0, 5.99291281904254}, {3, 2500.0, 49.8433203273588}, {6, 4.0, 0.417002722744693},
            {24, 5000.0, 69.6701316896632}, {301, 250.0, 0.0182614977971014}, {301, 1000000.0, 998.632653333099},
            {3000, 9000.0, 52.0225524203573}})
    {
        CAPTURE(known[0], known[1]);
        CHECK(zScoreOfChiSquared((int)known[0], known[1]) == Approx(known[2]).epsilon(1e-9));
    }
    CHECK(zScoreOfChiSquared(1, 49.) == 7.);
    for (int dof : {1, 2, 7})
    {
        CHECK(zScoreOfChiSquared(dof, 0.) == 0.);
        CHECK(zScoreOfChiSquared(dof, -1.) == 0.);
        CHECK(upperTailChiSquared(dof, std::numeric_limits<double>::infinity()) == 0.);
        CHECK(std::isinf(zScoreOfChiSquared(dof, std::numeric_limits<double>::infinity())));
    }
}
