// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The solver of a handful of parameters.
#include "math/least_squares.hpp"
#include "scenes.hpp"

#include <functional>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const LeastSquaresEnd END = { 500, 1e-30, 1e-14 };

//! Rosenbrock's curved valley in units of `unit`: 10 (y - x^2), 1 - x.
struct Valley
{
    double unit;
    std::function<bool(const Vec2d&)> hasValue;
    bool operator()(const Vec2d& scaled, SumOfSquares<2>& sum) const
    {
        const Vec2d p = scaled/unit;
        if (hasValue && !hasValue(p))
            return false;
        const Vec2d first(-20*p[0]/unit, 10/unit), second(-1/unit, 0);
        sum.add(10*(p[1] - p[0]*p[0]), first.val);
        sum.add(1 - p[0], second.val);
        return true;
    }
};

//! A random matrix of rows, and its J^T J.
SumOfSquares<6> randomRows(Random& random, const Vec6d& units, int rows, std::vector<Vec6d>& J)
{
    SumOfSquares<6> sum;
    for (int i = 0; i < rows; i++)
    {
        Vec6d row;
        for (int k = 0; k < 6; k++)
            row[k] = random.uniform(-1, 1)/units[k];
        J.push_back(row);
        sum.add(0, row.val);
    }
    return sum;
}

} // namespace

TEST_CASE("The minimum of a curved valley is found, whatever its unit", "[least_squares]")
{
    for (double unit : { 1e-9, 1e-3, 1., 1e3, 1e9 })
    {
        CAPTURE(unit);
        Vec2d x(-1.2*unit, 1*unit);
        CHECK(minimizeSquares(Valley{ unit, nullptr }, END, x) < 1e-20);
        CHECK(norm(x/unit - Vec2d(1, 1)) < 1e-9);
    }
}

TEST_CASE("Steps to where errors have no value are shortened", "[least_squares]")
{
    int refused = 0;
    const auto nearValley = [&](const Vec2d& p)
    {
        const bool isNear = std::abs(p[1] - p[0]*p[0]) < 0.6;
        refused += !isNear;
        return isNear;
    };
    Vec2d x(-1.2, 1.44);
    CHECK(minimizeSquares(Valley{ 1, nearValley }, END, x) < 1e-20);
    CHECK(norm(x - Vec2d(1, 1)) < 1e-9);
    CHECK(refused > 0);
}

TEST_CASE("A start without a value is left as it is, a start at the minimum too", "[least_squares]")
{
    Vec2d x(5, 5);
    CHECK(std::isnan(minimizeSquares(Valley{ 1, [](const Vec2d&) { return false; } }, END, x)));
    CHECK(x == Vec2d(5, 5));
    x = Vec2d(1, 1);
    CHECK(minimizeSquares(Valley{ 1, nullptr }, END, x) == 0);
    CHECK(x == Vec2d(1, 1));
}

TEST_CASE("A parameter without effect stays, and does not keep the others from their minimum", "[least_squares]")
{
    Vec3d x(3, -4, 7);
    const double sum = minimizeSquares([](const Vec3d& p, SumOfSquares<3>& squares)
    {
        const Vec3d first(1, 0, 0), second(1, 2, 0);
        squares.add(p[0] - 1, first.val);
        squares.add(p[0] + 2*p[1] - 5, second.val);
        return true;
    }, END, x);
    CHECK(sum < 1e-24);
    CHECK(norm(x - Vec3d(1, 2, 7)) < 1e-10);
}

TEST_CASE("Iterations end where they are told to", "[least_squares]")
{
    int places = 0;
    const auto count = [&](const Vec2d&) { places++; return true; };
    Vec2d x(-1.2, 1);
    const double start = minimizeSquares(Valley{ 1, count }, { 1, 0, 0 }, x);
    CHECK(x == Vec2d(-1.2, 1));
    CHECK(places == 1);
    CHECK(minimizeSquares(Valley{ 1, count }, { 20, 0, 0 }, x) < start);
    CHECK(places == 1 + 20);
}

TEST_CASE("The inverse of normal equations is exact in units that differ by many powers of ten", "[least_squares]")
{
    Random random(720);
    CAPTURE(seed());
    for (int i = 0; i < 100; i++)
    {
        Vec6d units;
        for (int k = 0; k < 6; k++)
            units[k] = random.logUniform(1e-9, 1e9);
        std::vector<Vec6d> J;
        const SumOfSquares<6> sum = randomRows(random, units, 20, J);
        Matx66d A = sum.curvature;
        for (int r = 0; r < 6; r++)
            for (int c = 0; c < r; c++)
                A(r, c) = A(c, r);
        const Matx66d product = inverseOfPositive(sum.curvature)*A;
        for (int r = 0; r < 6; r++)
            for (int c = 0; c < 6; c++)
                CHECK(std::abs(product(r, c)*units[c]/units[r] - (r == c)) < 1e-9);
    }
}

TEST_CASE("The inverse of what is singular is NaN", "[least_squares]")
{
    CHECK(std::isnan(inverseOfPositive(Matx22d(1, 1, 1, 1))(0, 0)));
    CHECK(std::isnan(inverseOfPositive(Matx22d(1, 0, 0, 0))(0, 0)));
    CHECK(std::isnan(inverseOfPositive(Matx22d(NaN, 0, 0, 1))(1, 1)));
    CHECK(inverseOfPositive(Matx22d(4, 0, 0, 1)) == Matx22d(0.25, 0, 0, 1));
}
