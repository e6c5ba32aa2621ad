// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The inner loops, compiled for every instruction set of this machine, through the inner header.
#include "kernel_levels.hpp"
#include "window/layers.hpp"
#include "scenes.hpp"

#include <array>
#include <functional>
#if defined(__x86_64__) && defined(__GNUC__)
#include <cpuid.h>
#endif

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const int MOST = 40;
typedef std::array<double, MOST + 1> Array;     // one more, which no kernel may touch

//! Whether the upper halves of vector registers are in use, which slows down what follows; false where one cannot tell.
bool upperHalvesInUse()
{
#if defined(__x86_64__) && defined(__GNUC__)
    unsigned a = 0, b, c, d;
    if (!__get_cpuid_count(0xD, 1, &a, &b, &c, &d) || !(a & 4))
        return false;
    __asm__ volatile("xgetbv" : "=a"(a), "=d"(d) : "c"(1));
    return (a & 0x44) != 0;
#else
    return false;
#endif
}

FisheyeModel angles()
{
    FisheyeModel m = {};
    m.fx = m.fy = 1;
    m.thetaMax = CV_PI;
    return m;
}

} // namespace

TEST_CASE("The fastest level of the machine is chosen", "[kernels]")
{
    CHECK(&kernels() == kernelLevels().back());
}

TEST_CASE("Every level computes the same, and no more points than it is given", "[kernels]")
{
    const WindowKind kind = GENERATE(PANE_IN_AIR, LAMINATE, AIR_GLASS_WATER, GLASS_ON_LENS, DOUBLE_GLAZING_IN_WATER);
    CAPTURE(name(kind), seed());
    Random random(kind);
    const Layers layers(makeWindow(kind, random));
    const Stack stack = layers.stack();
    for (const Kernels* level : kernelLevels())
        for (int n = 1; n <= MOST; n++)
        {
            CAPTURE(level->instructions, n);
            Array x, y, z, dx, dy, dz, tau, ox, oy, oz;
            for (Array* a : { &dx, &dy, &dz, &tau, &ox, &oy, &oz })
                a->fill(-7);
            for (int i = 0; i < n; i++)
            {
                const Vec3d X = 900*stack.normal[2]*layers.normal() + random.vector(150);
                x[i] = X[0]; y[i] = X[1]; z[i] = X[2];
            }
            REQUIRE(level->layer.solveIn(stack, n, x.data(), y.data(), z.data(), NULL, dx.data(), dy.data(), dz.data(), NULL));
            for (int i = 0; i < n; i++)
            {
                const double length = std::sqrt(dx[i]*dx[i] + dy[i]*dy[i] + dz[i]*dz[i]);
                dx[i] /= length; dy[i] /= length; dz[i] /= length;
            }
            REQUIRE(level->layer.traceOut(stack, n, dx.data(), dy.data(), dz.data(), tau.data(), ox.data(), oy.data(), oz.data()));
            for (const Array* a : { &dx, &dy, &dz, &tau, &ox, &oy, &oz })
                REQUIRE((*a)[n] == -7);
            for (int i = 0; i < n; i++)     // the ray meets its point
            {
                const Vec3d d(ox[i], oy[i], oz[i]), miss = (Vec3d(x[i], y[i], z[i]) - tau[i]*layers.normal()).cross(d);
                REQUIRE(norm(miss) < 1e-11);
            }
        }
}

TEST_CASE("Angles, sines and cosines of every level against long double", "[kernels]")
{
    for (const Kernels* level : kernelLevels())
    {
        CAPTURE(level->instructions);
        long double worst = 0, worstBack = 0;
        for (int i = 0; i <= 20000; i++)
        {
            const long double theta = 3.14159265358979323846264L*i/20001;
            const double X = (double)std::sin(theta), Y = 0, Z = (double)std::cos(theta);
            double u, v, x, y, z;
            REQUIRE(level->fisheye.project(angles(), 1, &X, &Y, &Z, &u, &v));
            const long double expected = std::atan2((long double)X, (long double)Z);
            worst = std::max(worst, std::abs(u - expected)/std::max(expected, 1e-300L));
            REQUIRE(level->fisheye.unproject(angles(), 1, &u, &v, &x, &y, &z));
            worstBack = std::max(worstBack, std::abs(x - std::sin((long double)u)));
            worstBack = std::max(worstBack, std::abs(z - std::cos((long double)u)));
        }
        CHECK(worst < 8e-16);
        CHECK(worstBack < 4e-16);
    }
}

TEST_CASE("A lane without an answer is NaN and leaves its neighbours alone", "[kernels]")
{
    Random random;
    const Layers layers(makeWindow(PANE_IN_AIR, random));
    for (const Kernels* level : kernelLevels())
        for (int bad = 0; bad < 19; bad++)
        {
            Array x, y, z, dx, dy, dz;
            for (int i = 0; i < 19; i++)
            {
                x[i] = 10*i; y[i] = 5; z[i] = i == bad ? -800 : 800;
            }
            CAPTURE(level->instructions, bad);
            REQUIRE_FALSE(level->layer.solveIn(layers.stack(), 19, x.data(), y.data(), z.data(), NULL, dx.data(), dy.data(), dz.data(),
                                         NULL));
            for (int i = 0; i < 19; i++)
                REQUIRE(std::isnan(dx[i]) == (i == bad));
        }
}

TEST_CASE("A chord is close where the cubic through its points stays within the tolerance", "[kernels]")
{
    Random random;
    const double TOLERANCE = 0.01;
    int known = 0, close = 0;
    for (const Kernels* level : kernelLevels())
        for (int n = 1; n <= 19; n++)
            for (int trial = 0; trial < 50; trial++)
            {
                // Segments along u of the curve v = a u + b u^2 + c u^3, u = t.
                const double a = random.uniform(-1, 1), b = random.uniform(-0.03, 0.03), c = random.uniform(-2e-3, 2e-3);
                const auto curve = [&](double t) { return t*(a + t*(b + t*c)); };
                Array t, v, tMiddle, vMiddle, slack;
                for (int i = 0; i <= n; i++)
                    t[i] = i == 0 ? -1. : t[i - 1] + random.uniform(0.5, 2);
                for (int i = 0; i < n; i++)
                    tMiddle[i] = 0.5*(t[i] + t[i + 1]);
                tMiddle[n] = 0.5*(t[n] + tMiddle[n - 1]);
                for (int i = 0; i <= n; i++)
                {
                    v[i] = curve(t[i]);
                    vMiddle[i] = curve(tMiddle[i]);
                }
                slack[n] = -7;
                const bool all = level->point.areClose(n, TOLERANCE, t.data(), t.data(), v.data(), tMiddle.data(), tMiddle.data(),
                                                 vMiddle.data(), slack.data());
                CAPTURE(level->instructions, n, trial);
                REQUIRE(slack[n] == -7);
                bool every = true;
                for (int i = 0; i < n; i++)
                {
                    const double du = t[i + 1] - t[i], dv = v[i + 1] - v[i];
                    double farthest = 0;
                    for (double p = 0; p <= 1; p += 1./64)
                        farthest = std::max(farthest, std::abs(du*(curve(t[i] + p*du) - v[i]) - dv*p*du)/std::hypot(du, dv));
                    every = every && !std::isnan(slack[i]);
                    if (!std::isnan(slack[i]))
                        REQUIRE(farthest <= TOLERANCE);
                    if (farthest < 0.8*TOLERANCE)
                        REQUIRE(!std::isnan(slack[i]));
                    known += farthest <= TOLERANCE;
                    close += !std::isnan(slack[i]);
                }
                REQUIRE(all == every);
            }
    CHECK(close > 0.9*known);
    CHECK(close < known);       // some are refused: the margin is tested
}

TEST_CASE("Where the middle of a chord is out of sight it has no answer, where the next middle is it has one", "[kernels]")
{
    for (const Kernels* level : kernelLevels())
        for (int bad = 0; bad <= 19; bad++)
        {
            Array t, v, tMiddle, slack;
            for (int i = 0; i < MOST; i++)
            {
                t[i] = i;
                v[i] = 0;
                tMiddle[i] = i + 0.5;
            }
            Array vMiddle = v;
            vMiddle[bad] = NAN;
            CAPTURE(level->instructions, bad);
            CHECK(level->point.areClose(19, 0.01, t.data(), t.data(), v.data(), tMiddle.data(), tMiddle.data(), vMiddle.data(),
                                  slack.data()) == (bad == 19));
            for (int i = 0; i < 19; i++)
                REQUIRE(std::isnan(slack[i]) == (i == bad));
        }
}

TEST_CASE("No kernel leaves upper halves of registers in use", "[kernels]")
{
    const Layers layers(GlassWindow(Vec3d(0.1, 0, 1), 20, 1.5, 30));
    const Stack stack = layers.stack();
    const double R[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 }, t[3] = {};
    for (const Kernels* level : kernelLevels())
        for (int n : { 1, 5, 8, 13, 16 })
        {
            CAPTURE(level->instructions, n);
            Array x, y, z, u, v, w, tau;
            x.fill(1); y.fill(2); z.fill(500);
            const auto clean = [](const std::function<void()>& call) { call(); return !upperHalvesInUse(); };
            CHECK(clean([&] { level->point.transform(R, t, n, x.data(), y.data(), z.data()); }));
            CHECK(clean([&] { level->layer.solveIn(stack, n, x.data(), y.data(), z.data(), NULL, u.data(), v.data(), w.data(), NULL); }));
            CHECK(clean([&] { level->layer.traceOut(stack, n, u.data(), v.data(), w.data(), tau.data(), x.data(), y.data(), z.data()); }));
            CHECK(clean([&] { level->point.chordRoots(n, x.data(), y.data(), u.data()); }));
            CHECK(clean([&] { level->point.areClose(n, 1, x.data(), y.data(), z.data(), u.data(), v.data(), w.data(),
                                              tau.data()); }));
            CHECK(clean([&] { level->point.pinhole(R, R + 6, n, x.data(), y.data(), z.data(), u.data(), v.data()); }));
        }
}
