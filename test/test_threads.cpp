// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// One camera used by several threads: what a lens makes at its first use is made once, before anyone reads it.
#include "scenes.hpp"

#include <atomic>
#include <thread>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

//! What one thread gets from a camera: rays of pixels, and pixels of points.
struct Answers
{
    std::vector<Vec3d> origins, directions;
    std::vector<Vec2d> pixels;
    std::vector<uchar> rayStatus, pixelStatus;

    bool operator==(const Answers& other) const
    {
        return origins == other.origins && directions == other.directions && pixels == other.pixels &&
               rayStatus == other.rayStatus && pixelStatus == other.pixelStatus;
    }
};

Answers ask(const Ptr<RefractiveCamera>& camera, const std::vector<Vec2d>& pixels)
{
    Answers a;
    refractiveUnprojectPoints(pixels, a.origins, a.directions, camera, a.rayStatus);
    std::vector<Vec3d> points;
    for (size_t i = 0; i < pixels.size(); i++)
        points.push_back(a.origins[i] + 700*a.directions[i]);
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, a.pixels, a.pixelStatus);
    return a;
}

const GlassWindow window(Vec3d(0.1, -0.05, 1), 20, 1.52, 31.7, 1.333);

std::vector<Vec2d> somePixels(const LensKind& kind)
{
    Random random;
    std::vector<Vec2d> pixels;
    for (int i = 0; i < 100; i++)
        pixels.push_back(Vec2d(kind.K(0, 2) + random.uniform(-200, 200), kind.K(1, 2) + random.uniform(-200, 200)));
    return pixels;
}

} // namespace

TEST_CASE("Many threads ask one camera while others change clones of it", "[camera][threads]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name, seed());
    const std::vector<Vec2d> pixels = somePixels(kind);
    const Answers expected = ask(makeCamera(kind, window), pixels);
    const Mat parameters = makeCamera(kind, window)->lensParameters();

    const Ptr<RefractiveCamera> camera = makeCamera(kind, window);
    std::atomic<int> wrong(0);
    const auto work = [&](bool changes)
    {
        for (int round = 0; round < 200; round++)
        {
            if (changes)
            {
                const Ptr<RefractiveCamera> own = camera->clone();
                own->setWindow(GlassWindow());
                Mat other = own->lensParameters();
                other.at<double>(2) += round;
                own->setLensParameters(other);
            }
            else
                wrong += !(ask(camera, pixels) == expected) || norm(camera->lensParameters(), parameters) != 0 ||
                         camera->window().normal != window.normal;
        }
    };
    std::vector<std::thread> threads;
    for (int i = 0; i < 8; i++)
        threads.emplace_back(work, i % 4 == 3);
    for (std::thread& thread : threads)
        thread.join();
    CHECK(wrong == 0);
}

TEST_CASE("A camera's first use by two threads at once gives what one thread gets", "[camera][threads]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name, seed());
    const std::vector<Vec2d> pixels = somePixels(kind);
    const Answers expected = ask(makeCamera(kind, window), pixels);
    REQUIRE(std::count(expected.rayStatus.begin(), expected.rayStatus.end(), (uchar)REFRACT_OK) == 100);
    REQUIRE(std::count(expected.pixelStatus.begin(), expected.pixelStatus.end(), (uchar)REFRACT_OK) == 100);

    // The moment in which a second thread would come too early is a microsecond long: both wait for each other, awake, before each
    // camera.
    std::vector<Ptr<RefractiveCamera> > cameras(300);
    for (Ptr<RefractiveCamera>& camera : cameras)
        camera = makeCamera(kind, window);
    std::atomic<int> arrived(0), wrong(0);
    const auto work = [&]
    {
        for (int i = 0; i < (int)cameras.size(); i++)
        {
            arrived++;
            for (int waited = 0; arrived < 2*(i + 1); waited++)
                if (waited > 1000)
                    std::this_thread::yield();
            wrong += !(ask(cameras[i], pixels) == expected);
        }
    };
    std::thread other(work);
    work();
    other.join();
    CHECK(wrong == 0);
}
