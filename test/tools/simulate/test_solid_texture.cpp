// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The texture of scenes: made of its seed alone, textured at every scale, and without what samples cannot show.
#include "scenes.hpp"
#include "simulate/surface.hpp"

#include <algorithm>

using cv::Vec3d;
using tools::SolidTexture;
using tools::TextureOptions;

namespace {

TextureOptions options(double size, double contrast, int octaves)
{
    TextureOptions result;
    result.size = size;
    result.contrast = contrast;
    result.octaves = octaves;
    return result;
}

} // namespace

TEST_CASE("a texture depends on its seed and the place, and on nothing else", "[simulate][texture]")
{
    CAPTURE(scenes::seed());
    scenes::Random random(911);
    const SolidTexture one(options(60, 0.8, 8), 1), same(options(60, 0.8, 8), 1), other(options(60, 0.8, 8), 2);
    int different = 0;
    for (int i = 0; i < 1000; i++)
    {
        const Vec3d X = random.vector(2000);
        CHECK(one.at(X, 0.1) == same.at(X, 0.1));
        different += std::abs(one.at(X, 0.1) - other.at(X, 0.1)) > 0.01;
        CHECK((one.at(X, 0.1) > 0.2 - 1e-12 && one.at(X, 0.1) < 1 + 1e-12));
    }
    CHECK(different > 900);
}

TEST_CASE("a texture has its full contrast on any plane, and no jumps", "[simulate][texture]")
{
    CAPTURE(scenes::seed());
    scenes::Random random(912);
    const SolidTexture texture(options(8, 1, 4), 3);
    for (int plane = 0; plane < 6; plane++)
    {
        // Along the axes, where a lattice would show, and askew.
        const Vec3d point = plane < 3 ? Vec3d() : random.vector(500);
        const Vec3d right = plane < 3 ? Vec3d(plane == 0, plane == 1, plane == 2) : normalize(random.vector(1));
        const Vec3d down = plane < 3 ? Vec3d(plane == 2, plane == 0, plane == 1) : normalize(right.cross(random.vector(1)));
        double sum = 0, squares = 0, jump = 0;
        const int N = 300;
        for (int i = 0; i < N; i++)
            for (int j = 0; j < N; j++)
            {
                const Vec3d X = point + 0.7*i*right + 0.7*j*down;
                const double value = texture.at(X, 1e-6);
                sum += value;
                squares += value*value;
                jump = std::max(jump, std::abs(texture.at(X + 1e-6*right, 1e-6) - value));
            }
        const double mean = sum/(N*N), deviation = std::sqrt(squares/(N*N) - mean*mean);
        CAPTURE(plane, mean, deviation);
        CHECK(std::abs(mean - 0.5) < 0.03);
        CHECK((deviation > 0.2 && deviation < 0.3));
        CHECK(jump < 1e-5);
    }
}

TEST_CASE("each octave adds differences of its own size", "[simulate][texture]")
{
    CAPTURE(scenes::seed());
    scenes::Random random(913);
    const SolidTexture texture(options(64, 1, 8), 4), coarse(options(64, 1, 1), 4);
    double last = 0;
    for (const double step : {0.25, 1., 4., 16.})
    {
        double squares = 0, ofCoarse = 0;
        for (int i = 0; i < 20000; i++)
        {
            const Vec3d X = random.vector(500), Y = X + Vec3d(step, 0, 0);
            squares += std::pow(texture.at(X, 1e-6) - texture.at(Y, 1e-6), 2)/20000;
            ofCoarse += std::pow(coarse.at(X, 1e-6) - coarse.at(Y, 1e-6), 2)/20000;
        }
        CAPTURE(step);
        CHECK(std::sqrt(squares) > last + 0.03);
        if (step <= 1)
            CHECK(squares > 16*ofCoarse);
        last = std::sqrt(squares);
    }
}

TEST_CASE("octaves finer than the samples are left out, far places have none", "[simulate][texture]")
{
    CAPTURE(scenes::seed());
    scenes::Random random(914);
    const SolidTexture fine(options(16, 0.8, 5), 5), all(options(16, 0.8, 1), 5);      // 16, 8, 4, 2, 1
    for (int i = 0; i < 1000; i++)
    {
        const Vec3d X = random.vector(300);
        CHECK(fine.at(X, 16) == 1 - 0.8/2);
        CHECK(fine.at(X, 1e30) == 1 - 0.8/2);
        CHECK(fine.at(X, 0.5) == fine.at(X, 0.));
        CHECK(fine.at(1e18*X, 0.5) == 1 - 0.8/2);
        // One octave of five has 1/sqrt(5) of the strength that it has alone, before the tanh.
        const double alone = std::atanh((all.at(X, 1e-6) - 0.6)/0.4), amongOthers = std::atanh((fine.at(X, 8) - 0.6)/0.4);
        CHECK(std::abs(alone/std::sqrt(5.) - amongOthers) < 1e-9);
    }
}
