// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Where radial functions stop increasing, and their inverse.
#include "math/monotone.hpp"
#include "scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

//! p (1 + linear s + square s^2)
std::vector<double> times(const std::vector<double>& p, double linear, double square = 0)
{
    std::vector<double> product(p.size() + (square == 0 ? 1 : 2), 0.);
    for (size_t i = 0; i < p.size(); i++)
    {
        product[i] += p[i];
        product[i + 1] += linear*p[i];
        if (square != 0)
            product[i + 2] += square*p[i];
    }
    return product;
}

double rootOf(const std::vector<double>& coefficients)
{
    return firstPositiveRoot(coefficients.data(), (int)coefficients.size());
}

//! y (1 + y^2 (c[0] + c[1] y^2 + ...))
double fittedInverse(const std::vector<double>& c, double y)
{
    double sum = 0;
    for (size_t i = c.size(); i-- > 0; )
        sum = sum*y*y + c[i];
    return y*(1 + y*y*sum);
}

} // namespace

TEST_CASE("The first positive root is found among others, real and complex, near and far", "[monotone]")
{
    Random random(700);
    CAPTURE(seed());
    for (int i = 0; i < 2000; i++)
    {
        const double root = random.logUniform(0.01, 10);       // r^2 or theta^2: wider than any lens
        std::vector<double> p = times({ random.logUniform(0.01, 100) }, -1/root);
        while (p.size() < 7 && random.below(4) != 0)
        {
            const double size = root*random.logUniform(1.5, 10);
            const int kind = random.below(p.size() < 6 ? 3 : 2);
            if (kind == 2)                              // (1 - s/z) (1 - s/z*), |z| = size
                p = times(p, -2*random.uniform(-0.9, 0.9)/size, 1/(size*size));
            else
                p = times(p, (kind == 0 ? 1 : -1)/size);
        }
        CAPTURE(root, p.size());
        CHECK(rootOf(p) == Approx(root).epsilon(1e-9));
    }
}

TEST_CASE("A polynomial without a positive root never ends", "[monotone]")
{
    CHECK(rootOf({ 3 }) == INF);
    CHECK(rootOf({ 1, 0, 0 }) == INF);
    CHECK(rootOf({ 1, 2, 3, 4 }) == INF);
    CHECK(rootOf({ 1, 2, 3, 4, 5, 6, 7 }) == INF);
    CHECK(rootOf({ 1, -0.5, 1 }) == INF);               // complex
    CHECK(rootOf(times({ 1, 0, 1 }, 0, 2)) == INF);     // (1 + s^2) (1 + 2 s^2)
}

TEST_CASE("A root that only touches zero, vanishing terms and terms of very different size are no obstacle", "[monotone]")
{
    CHECK(rootOf({ 1, -1, 0.25 }) == Approx(2));        // (1 - s/2)^2
    CHECK(rootOf({ 1, -0.5, 0, 0, 0, 0, 0 }) == Approx(2).epsilon(1e-14));
    CHECK(rootOf({ 1, -0.5, 1e-30 }) == Approx(2).epsilon(1e-14));
    CHECK(rootOf({ 1, -0.5, 0, 0, 0, 0, 1e-20 }) == Approx(2).epsilon(1e-12));
    CHECK(rootOf({ 1, -1e-12 }) == Approx(1e12).epsilon(1e-12));
    CHECK(rootOf({ 1, -1e12 }) == Approx(1e-12).epsilon(1e-12).margin(0));
    CHECK(rootOf({ 1e-100, -1e-100 }) == Approx(1).epsilon(1e-12));
}

TEST_CASE("A function that increases is inverted up to its end and no farther", "[monotone]")
{
    const auto cubic = [](double x, double& slope) { slope = 1 + 3*x*x; return x + x*x*x; };
    const auto folding = [](double x, double& slope) { slope = 1 - x*x; return x - x*x*x/3; };     // up to x = 1
    const auto bounded = [](double x, double& slope) { slope = 1/((1 + x)*(1 + x)); return x/(1 + x); };
    const auto tangent = [](double x, double& slope) { slope = 1 + std::tan(x)*std::tan(x); return std::tan(x); };
    Random random(710);
    CAPTURE(seed());
    for (int i = 0; i < 1000; i++)
    {
        double slope;
        const double any = random.logUniform(1e-6, 1e3), below = random.uniform(0, 0.999);
        CHECK(invertMonotone(cubic, cubic(any, slope), INF) == Approx(any).epsilon(1e-12).margin(0));
        CHECK(invertMonotone(folding, folding(below, slope), 1) == Approx(below).epsilon(1e-9).margin(1e-15));
        CHECK(invertMonotone(tangent, std::tan(1.57*below), CV_PI/2) == Approx(1.57*below).epsilon(1e-12).margin(1e-15));
    }
    CHECK(invertMonotone(bounded, 0.999999, INF) == Approx(999999).epsilon(1e-9));
    CHECK(invertMonotone(tangent, 1e12, CV_PI/2) == Approx(CV_PI/2).epsilon(1e-11));
    CHECK(std::isnan(invertMonotone(folding, 2./3 + 1e-6, 1)));
    CHECK(std::isnan(invertMonotone(bounded, 1., INF)));
    CHECK(std::isnan(invertMonotone(bounded, 2., INF)));

    CHECK(invertMonotone(cubic, 0., INF) == 0);
    for (const double target : { -1e-300, -1., INF, -INF, NaN })
        CHECK(std::isnan(invertMonotone(cubic, target, INF)));
}

TEST_CASE("A polynomial goes through its points", "[monotone]")
{
    Random random(720);
    CAPTURE(seed());
    for (int n = 1; n <= 8; n++)
    {
        std::vector<double> coefficients, x, y;
        for (int i = 0; i < n; i++)
            coefficients.push_back(random.uniform(-1, 1));
        for (int i = 0; i < n; i++)
        {
            x.push_back(i - 0.4*n + random.uniform(-0.3, 0.3));
            double sum = 0;
            for (int k = n; k-- > 0; )
                sum = sum*x[i] + coefficients[k];
            y.push_back(sum);
        }
        fitPolynomial(n, x.data(), y.data());
        for (int k = 0; k < n; k++)
        {
            CAPTURE(n, k);
            CHECK(y[k] == Approx(coefficients[k]).margin(1e-9));
        }
    }
}

TEST_CASE("A search for the inverse begins the nearer, the more terms it has", "[monotone]")
{
    const auto barrel = [](double x, double& slope) { slope = 1 - 0.6*x*x; return x*(1 - 0.2*x*x); };
    const double upper = 0.9;           // it folds at 1.29
    double before = 1;
    for (const int terms : { 2, 4, 6, 8 })
    {
        std::vector<double> c(terms);
        fitInverse(barrel, upper, terms, c.data());
        double worst = 0, slope;
        for (int i = 0; i <= 100; i++)
            worst = std::max(worst, std::abs(fittedInverse(c, barrel(upper*i/100, slope)) - upper*i/100));
        CAPTURE(terms);
        CHECK(worst < before/5);
        before = worst;
        for (int i = 0; i < terms; i++)
        {
            const double node = upper*std::cos(0.25*CV_PI*(2*i + 1)/terms);
            CHECK(fittedInverse(c, barrel(node, slope)) == Approx(node).epsilon(1e-12));
        }
    }
    CHECK(before < 2e-6);
}
