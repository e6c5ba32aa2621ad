// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// How large errors usually are where some of them are wrong.
#include "math/quantile.hpp"
#include "math/robust_scale.hpp"
#include "scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const double SIGMA = 0.3;

//! Lengths of errors in the image; so large a part of them is wrong by far.
std::vector<double> errorsOf(int count, double wrong, Random& random, double sigma = SIGMA)
{
    std::vector<double> errors;
    for (int i = 0; i < count; i++)
        errors.push_back(i < wrong*count ? random.uniform(20, 500)*sigma : std::hypot(random.normal(sigma), random.normal(sigma)));
    return errors;
}

} // namespace

TEST_CASE("The median is one of the values, whatever the others are", "[robust_scale]")
{
    CHECK(median({}) == 0);
    CHECK(median({ 7 }) == 7);
    CHECK(median({ 9, 1, 5 }) == 5);
    CHECK(median({ 4, 3, 2, 1 }) == 3);         // the upper one of two
    CHECK(median({ INF, 2, INF, 1, 3 }) == 3);
    CHECK(median({ -1e300, 0, 1e300 }) == 0);
}

TEST_CASE("A quantile has its share of the values below it, and leaves NaN out", "[robust_scale]")
{
    CHECK(std::isnan(quantile(std::vector<double>(), 0.5)));
    CHECK(std::isnan(quantile(std::vector<double>(3, NaN), 0.5)));
    CHECK(quantile(std::vector<float>{ 3, (float)NaN, 1, 2 }, 0.) == 1);
    CHECK(quantile(std::vector<double>{ 3, NaN, 1, 2 }, 0.5) == 2);
    CHECK(quantile(std::vector<double>{ 3, NaN, 1, INF }, 1.) == INF);
    std::vector<uchar> all(100);
    for (int i = 0; i < 100; i++)
        all[i] = (uchar)(i*37 % 100);
    for (const double share : { 0., 0.01, 0.25, 0.5, 0.75, 0.95, 0.99 })
        CHECK(quantile(all, share) == std::floor(100*share + 1e-9));
}

TEST_CASE("The scale is that of the errors that are right", "[robust_scale]")
{
    Random random(730);
    CAPTURE(seed());
    CHECK(scaleOf(errorsOf(40000, 0, random)) == Approx(SIGMA).epsilon(0.02));
    // The median of all is a higher quantile of those that are right: sqrt(-2 ln(1 - 0.5/0.7)).
    CHECK(scaleOf(errorsOf(40000, 0.3, random)) == Approx(SIGMA*std::sqrt(-2*std::log(1 - 0.5/0.7))/1.17741).epsilon(0.02));
    CHECK(scaleOf(errorsOf(40000, 0, random, 1e5)) == Approx(1e5).epsilon(0.02));
    CHECK(scaleOf({}) == LEAST_SCALE);
    CHECK(scaleOf(std::vector<double>(50, 0.)) == LEAST_SCALE);
    CHECK(scaleOf({ INF, INF, INF, 0.1 }) == INF);      // most points have no image
}

TEST_CASE("A good error exceeds the cut with a chance of 1e-4", "[robust_scale]")
{
    CHECK(std::exp(-CUT*CUT/2) == Approx(1e-4));
}

TEST_CASE("What a cut takes from the mean square is what it takes from errors", "[robust_scale]")
{
    Random random(740);
    CAPTURE(seed());
    const std::vector<double> errors = errorsOf(400000, 0, random, 1.);
    for (const double cut : { 0.5, 1., 2., 3., CUT })
    {
        double sum = 0;
        int count = 0;
        for (const double r : errors)
            if (r < cut)
            {
                sum += r*r;
                count++;
            }
        CAPTURE(cut);
        CHECK(truncationFactor(cut) == Approx(sum/count/2).epsilon(0.02));
    }
    CHECK(truncationFactor(0.1) == Approx(0.0025).epsilon(0.01));       // x/2 where x = cut^2/2 is small
    CHECK(truncationFactor(30) == 1);
}

TEST_CASE("The scale below a cut is found from a guess that is too small or too large", "[robust_scale]")
{
    Random random(750);
    CAPTURE(seed());
    for (const double wrong : { 0., 0.1, 0.3 })
        for (const double guess : { 0.6, 1., 1.5, 2. })
        {
            CAPTURE(wrong, guess);
            CHECK(truncatedScale(errorsOf(20000, wrong, random), guess*SIGMA, 3) == Approx(SIGMA).epsilon(0.03));
        }
}

TEST_CASE("Without errors below the cut the guess stays, and perfect data have the least scale", "[robust_scale]")
{
    CHECK(truncatedScale({}, 0.2, 3) == 0.2);
    CHECK(truncatedScale({ 5, 7, INF }, 0.2, 3) == 0.2);
    CHECK(truncatedScale(std::vector<double>(50, 0.), 0.2, 3) == LEAST_SCALE);
}
