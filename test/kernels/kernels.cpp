// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What the kernels of one level (REFRACT_TESTED_KERNELS) compute, one "name value" a line, for compare.py of ../agreement. All
// input is made by exact arithmetic or decimal literals, so that every build starts from the same bits.
#include "dispatch/kernels.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

using namespace cv::refract;

namespace {

const int N = 21;                   // no multiple of any number of lanes: the last register is not full
typedef std::array<double, N> Array;

struct Points
{
    Array x, y, z;
};

void print(const std::string& name, const Array& values)
{
    for (int i = 0; i < N; i++)
        std::printf("%s[%d] %.17g\n", name.c_str(), i, values[i]);
}

void print(const std::string& name, const Points& points)
{
    print(name + ".x", points.x);
    print(name + ".y", points.y);
    print(name + ".z", points.z);
}

//! Whether a kernel, or a lane, has its answer; never 0, as differences are relative.
void print(const std::string& name, bool answered)
{
    std::printf("%s.answered %d\n", name.c_str(), answered ? 1 : 2);
}

Medium medium(double height, double index, bool isScene)
{
    const double rarest = 1;
    return { height, isScene, 1, index*index, 1/index, 1/std::sqrt((index - rarest)*(index + rarest)) };
}

//! The scene in front of a tilted pane that keeps water out: air, glass, water.
Points scene(const Kernels& kernels)
{
    std::array<float, 3*N> interleaved;
    for (int i = 0; i < N; i++)
    {
        interleaved[3*i] = 17.f*i - 165;
        interleaved[3*i + 1] = 13.f*((5*i) % N) - 124;
        interleaved[3*i + 2] = 560.f + 9*i;
    }
    Points points;
    print("load", kernels.array.load(interleaved.data(), true, N, points.x.data(), points.y.data(), points.z.data()));
    return points;
}

void normalize(Points& directions)
{
    for (int i = 0; i < N; i++)
    {
        double &x = directions.x[i], &y = directions.y[i], &z = directions.z[i];
        const double length = std::sqrt(x*x + y*y + z*z);
        x /= length; y /= length; z /= length;
    }
}

//! Point -> direction -> ray; the directions are what the lenses get.
Points throughWindow(const Kernels& kernels, const Points& points)
{
    const Medium media[] = { medium(50, 1, false), medium(0, 1.333, true), medium(20, 1.5437, false) };
    const double heights[] = { 50, 20 }, indices[] = { 1, 1.5437 };
    const Stack stack = { { 0.28, 0.2688, 0.9216 }, true, 70, 1, 1.333, 1, media, 3, heights, indices, 2, {} };     // no derivatives
    Points inner, outer;
    Array tau;
    print("solveIn", kernels.layer.solveIn(stack, N, points.x.data(), points.y.data(), points.z.data(), nullptr,
                                     inner.x.data(), inner.y.data(), inner.z.data(), nullptr));
    normalize(inner);
    print("traceOut", kernels.layer.traceOut(stack, N, inner.x.data(), inner.y.data(), inner.z.data(),
                                       tau.data(), outer.x.data(), outer.y.data(), outer.z.data()));
    print("inner", inner);
    print("tau", tau);
    print("outer", outer);

    for (const int missing : { 4, 7 })      // whatever its place in the register, it is noticed
    {
        Points behind = points;
        behind.z[missing] = -behind.z[missing];
        const std::string name = "behind" + std::to_string(missing);
        print(name, kernels.layer.solveIn(stack, N, behind.x.data(), behind.y.data(), behind.z.data(), nullptr,
                                    outer.x.data(), outer.y.data(), outer.z.data(), nullptr));
        for (int i = 0; i < N; i++)
            print(name + "[" + std::to_string(i) + "]", !std::isnan(outer.x[i]));
    }
    return inner;
}

//! Direction -> pixel -> direction.
template<typename Model, typename Project, typename Unproject>
void throughLens(const std::string& name, const Model& model, Project project, Unproject unproject, const Points& directions)
{
    Array u, v;
    Points back;
    print(name + ".project", project(model, N, directions.x.data(), directions.y.data(), directions.z.data(), u.data(), v.data()));
    print(name + ".unproject", unproject(model, N, u.data(), v.data(), back.x.data(), back.y.data(), back.z.data()));
    print(name + ".u", u);
    print(name + ".v", v);
    print(name, back);
}

} // namespace

int main()
{
    const Kernels& kernels = *REFRACT_TESTED_KERNELS();
    const Points directions = throughWindow(kernels, scene(kernels));

    OpenCVModel plane = {};
    plane.fx = 2438.5; plane.fy = 2440.125; plane.cx = 644.25; plane.cy = 500.5;
    plane.k[K1] = -0.208; plane.k[K2] = 0.136; plane.k[P1] = 0.001; plane.k[P2] = -0.0005; plane.k[K3] = 0.03;
    plane.sMax = std::numeric_limits<double>::infinity();
    plane.untilt[0] = 1/plane.fx; plane.untilt[4] = 1/plane.fy; plane.untilt[8] = 1;
    throughLens("opencv", plane, kernels.openCV.project, kernels.openCV.unproject, directions);

    FisheyeModel sphere = {};
    sphere.fx = 820; sphere.fy = 822.5; sphere.cx = 644.25; sphere.cy = 500.5;
    sphere.k[0] = -0.02; sphere.k[1] = 0.004; sphere.k[2] = -0.001;
    sphere.thetaMax = 1.5;
    throughLens("fisheye", sphere, kernels.fisheye.project, kernels.fisheye.unproject, directions);
}
