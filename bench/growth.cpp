// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// How cost grows: with points, layers, incidence, views.
#include "boards.hpp"
#include "growth.hpp"
#include "measure.hpp"

#include <cstdio>

using namespace cv;
using namespace cv::refract;

namespace bench {

namespace {

const Vec3d ZERO(0, 0, 0);

//! What the calls below read, and where they write.
struct Calls
{
    Ptr<RefractiveCamera> camera;
    Matx33d K;
    std::vector<Point2d> pixels, found;
    std::vector<double> depths;
    std::vector<Point3d> points, origins, directions;
    std::vector<uchar> status;

    void undistort() { refractiveUndistortPoints(pixels, found, camera, depths, noArray(), K, status); }
    void unproject() { refractiveUnprojectPoints(pixels, origins, directions, camera, status); }
    void project() { refractiveProjectPoints(points, ZERO, ZERO, camera, found, status); }
    double nsPerPoint(void (Calls::*call)())
    {
        const int repeats = std::max(1, 1000/(int)pixels.size());   // asking the time takes its time
        const Work work = [=] { for (int i = 0; i < repeats; i++) (this->*call)(); };
        return medianSeconds(work, 3)/repeats/pixels.size()*1e9;
    }
};

Calls callsOf(const Scene& scene, int count)
{
    Points p(scene, count);
    return { scene.camera, scene.K, std::move(p.pixels), {}, std::move(p.depths), std::move(p.points), {}, {}, {} };
}

void growWithPoints()
{
    std::printf("\n%10s%12s%12s   ns per point\n", "points", "undistort", "project");
    const Scene scene(FIVE, 1);
    for (int count = 1; count <= 10000000; count *= 10)
    {
        Calls calls = callsOf(scene, count);
        const double undistort = calls.nsPerPoint(&Calls::undistort), project = calls.nsPerPoint(&Calls::project);
        std::printf("%10d%12.1f%12.1f\n", count, undistort, project);
    }
}

//! Layers of unlike indices, 20 mm in all; water behind.
void growWithLayers()
{
    std::printf("\n%10s%12s%12s   ns per point\n", "layers", "undistort", "project");
    Scene scene(FIVE, 1.333);
    for (int layers = 1; layers <= 5; layers++)
    {
        scene.window.thickness.assign(layers, 20./layers);
        scene.window.index.clear();
        for (int k = 0; k < layers; k++)
            scene.window.index.push_back(1.5437 - 0.02*k);
        scene.camera = RefractiveCamera::create(scene.K, scene.D, scene.window);
        Calls calls = callsOf(scene, 10000);
        const double undistort = calls.nsPerPoint(&Calls::undistort), project = calls.nsPerPoint(&Calls::project);
        std::printf("%10d%12.1f%12.1f\n", layers, undistort, project);
    }
}

//! A fisheye lens behind a pane across its axis sees a cone of directions at each incidence.
void growWithIncidence()
{
    std::printf("\n%10s%12s%12s   ns per point\n", "incidence", "unproject", "project");
    const Scene scene(FISHEYE, 1);
    const Ptr<RefractiveCamera> bare = RefractiveCamera::createFisheye(scene.K, scene.D);
    const GlassWindow window(Vec3d(0, 0, 1), 20, 1.5437, 50);
    for (double degrees : { 0., 20., 40., 60., 70., 80., 85., 88., 89., 89.5, 89.9 })
    {
        const double theta = degrees*CV_PI/180;
        Calls calls = callsOf(scene, 10000);
        calls.camera = RefractiveCamera::createFisheye(scene.K, scene.D, window);
        for (size_t i = 0; i < calls.points.size(); i++)
        {
            const double azimuth = 2*CV_PI*(double)i/calls.points.size();
            calls.points[i] = Point3d(std::sin(theta)*std::cos(azimuth), std::sin(theta)*std::sin(azimuth),
                                      std::cos(theta));
        }
        refractiveProjectPoints(calls.points, ZERO, ZERO, bare, calls.pixels);
        const double unproject = calls.nsPerPoint(&Calls::unproject);
        for (size_t i = 0; i < calls.points.size(); i++)
            calls.points[i] = calls.origins[i] + calls.directions[i]*((500 - calls.origins[i].z)/calls.directions[i].z);
        const double project = calls.nsPerPoint(&Calls::project);
        std::printf("%10.1f%12.1f%12.1f\n", degrees, unproject, project);
    }
}

void growWithViews()
{
    std::printf("\n%10s%24s%24s   ms, and us per pair of corners\n", "views", "calibrateGlass", "calibrateGlassNormal");
    for (int views : { 1, 3, 10, 30, 100, 300, 1000 })
    {
        const Boards boards(views);
        const double glass = medianSeconds([&] { boards.calibrateGlass(); }, 1),
                     normal = medianSeconds([&] { boards.calibrateNormal(); }, 1), pairs = views*Boards::CORNERS;
        std::printf("%10d%12.1f%12.2f%12.1f%12.2f\n", views, glass*1e3, glass/pairs*1e6, normal*1e3, normal/pairs*1e6);
    }
}

} // namespace

void printGrowth()
{
    growWithPoints();
    growWithLayers();
    growWithIncidence();
    growWithViews();
}

} // namespace bench
