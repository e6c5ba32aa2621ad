// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Exact data for every calibrator, as people try first: to the last digit, or as a file has it, behind windows that are tilted or
// straight to the last digit.
#include "bundle_scenes.hpp"
#include "adjust/direction_manifold.hpp"
#include <ceres/line_manifold.h>
#include <ceres/sphere_manifold.h>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

//! Two cameras side by side, each behind a window of its own.
RigTruth twoCameras(bool isStraight, double outerIndex)
{
    RigTruth truth = makeRig(2, { 0, 1 }, outerIndex);
    for (const Ptr<RefractiveCamera>& camera : truth.cameras)
    {
        GlassWindow window = camera->window();
        if (isStraight)
            window.normal = Vec3d(0, 0, 1);
        camera->setWindow(window);
    }
    return truth;
}

//! As a file with six decimals.
void printAll(std::vector<PixelViews>& cameras)
{
    for (PixelViews& views : cameras)
        for (std::vector<Point2d>& pixels : views)
            for (Point2d& p : pixels)
                p = Point2d(std::round(p.x*1e6)/1e6, std::round(p.y*1e6)/1e6);
}

//! No start is the answer.
template<typename Call>
void tiltStarts(Call& call, Random& random)
{
    for (const Ptr<RefractiveCamera>& camera : call.cameras)
    {
        GlassWindow window = camera->window();
        window.normal = normalize(Vec3d(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 1));
        camera->setWindow(window);
    }
}

void check(const std::vector<Ptr<RefractiveCamera> >& found, const RigTruth& truth)
{
    for (size_t c = 0; c < found.size(); c++)
    {
        const GlassWindow window = found[c]->window(), expected = truth.cameras[c]->window();
        CHECK(norm(window.normal - normalize(expected.normal)) < 1e-6);
        CHECK(std::abs(window.distance - expected.distance) < 1e-3);
    }
}

} // namespace

TEST_CASE("Exact data give the windows back by every calibrator, straight or tilted, to the last digit or printed",
          "[calibrate][exact_data]")
{
    CAPTURE(seed());
    for (int trial = 0; trial < 2; trial++)
        for (bool isStraight : { true, false })
            for (bool isPrinted : { false, true })
                for (bool isPaired : { true, false })
                {
                    CAPTURE(trial, isStraight, isPrinted, isPaired);
                    Random random(9100 + trial);
                    const RigTruth truth = twoCameras(isStraight, 1.333);
                    RigScene scene = makeRigScene(truth, 6, random, 0);
                    if (isPrinted)
                    {
                        printAll(scene.refracted);
                        printAll(scene.direct);
                    }
                    RigCall rig(truth, scene, isPaired);
                    tiltStarts(rig, random);
                    CHECK(rig.run(GLASS_FREE_DISTANCE | GLASS_FREE_EXTRINSICS) < 1e-6);
                    check(rig.cameras, truth);

                    RigCall one(truth, scene, isPaired), pair(truth, scene, isPaired);
                    tiltStarts(one, random);
                    tiltStarts(pair, random);
                    const std::vector<Mat> none;
                    std::vector<Mat> rvecs, tvecs;
                    CHECK(calibrateGlass(one.object, isPaired ? one.direct[0] : none, one.refracted[0], one.cameras[0], rvecs, tvecs,
                                         GLASS_FREE_DISTANCE) < 1e-6);
                    check({ one.cameras[0] }, truth);
                    Mat R = pair.Rs[1], T = pair.Ts[1];
                    const auto direct = [&](int c) { return isPaired ? pair.direct[c] : none; };
                    CHECK(stereoCalibrateGlass(pair.object, direct(0), pair.refracted[0], direct(1), pair.refracted[1], pair.cameras[0],
                                               pair.cameras[1], R, T, rvecs, tvecs,
                                               GlassRigOptions(GLASS_FREE_DISTANCE | GLASS_FREE_EXTRINSICS)).rms < 1e-6);
                    check(pair.cameras, truth);

                    BundleScene points = makeMovingScene(truth, 4, 40, random, 0);
                    if (isPrinted)
                        printAll(points.pixels);
                    BundleCall bundle(truth, points, random, 0.3);
                    CHECK(bundle.run(GLASS_FREE_EXTRINSICS) < 1e-6);
                    check(bundle.cameras, truth);
                }
}

TEST_CASE("A step of nothing leaves a direction where it is, however near to an axis", "[calibrate][exact_data]")
{
    CAPTURE(seed());
    Random random(9110);
    for (double angle : { 0., 1e-12, 1e-9, 1e-8, 1.4e-8, 1e-7, 0.1 })
        for (double z : { 1., -1. })
            for (bool isLine : { false, true })
            {
                CAPTURE(angle, z, isLine);
                std::unique_ptr<ceres::Manifold> directions(new ceres::SphereManifold<3>());
                if (isLine)
                    directions.reset(new ceres::LineManifold<3>());
                const DirectionManifold manifold(std::move(directions));
                const int size = manifold.AmbientSize(), free = manifold.TangentSize();
                std::vector<double> x(size, 3.), moved(size), back(free), delta(free), J(size*free), K(size*free);
                const Vec3d direction = normalize(Vec3d(0.6*angle, -0.8*angle, z));
                std::copy_n(direction.val, 3, &x[size - 3]);
                for (double step : { 1e-30, 1e-12, 1e-6 })
                {
                    CAPTURE(step);
                    for (double& d : delta)
                        d = random.uniform(-step, step);
                    REQUIRE(manifold.Plus(x.data(), delta.data(), moved.data()));
                    REQUIRE(manifold.PlusJacobian(x.data(), J.data()));
                    REQUIRE(manifold.Minus(moved.data(), x.data(), back.data()));
                    REQUIRE(manifold.MinusJacobian(x.data(), K.data()));
                    const Mat byDelta(size, free, CV_64F, J.data()), byMoved(free, size, CV_64F, K.data());
                    CHECK(norm(Mat(moved) - Mat(x) - byDelta*Mat(delta)) < 1e-15 + step*step);
                    CHECK(norm(Mat(back) - Mat(delta)) < 1e-15 + step*step);
                    CHECK(norm(byMoved*byDelta - Mat::eye(free, free, CV_64F)) < 1e-7);
                    const Vec3d d(&moved[size - 3]);
                    CHECK(std::abs(norm(d) - 1) < 1e-15);
                }
            }
}
