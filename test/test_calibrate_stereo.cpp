// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "rig_scenes.hpp"
#include "window/wedge.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

struct StereoScene
{
    ObjectViews object;
    PixelViews refracted1, direct1, refracted2, direct2;
    std::vector<Vec3d> rvecs, tvecs;
};

struct StereoRig
{
    Ptr<RefractiveCamera> camera1, camera2;
    Matx33d R;
    Vec3d T;
};

StereoRig paperRig()
{
    const RigTruth rig = paperStereo();
    return { rig.cameras[0], rig.cameras[1], rig.Rs[1], rig.Ts[1] };
}

//! Camera 2 looks through the pane of camera 1.
void sharePane(StereoRig& rig)
{
    GlassWindow window = rig.camera1->window();
    window.normal = rig.R*window.normal;
    window.distance += window.normal.dot(rig.T);
    rig.camera2->setWindow(window);
}

StereoRig withWindows(const StereoRig& rig, const GlassWindow& window1, const GlassWindow& window2)
{
    StereoRig other = rig;
    other.camera1 = RefractiveCamera::create(rig.camera1->cameraMatrix(), rig.camera1->distCoeffs(), window1);
    other.camera2 = RefractiveCamera::create(rig.camera2->cameraMatrix(), rig.camera2->distCoeffs(), window2);
    return other;
}

StereoScene makeStereoScene(const StereoRig& rig, int views, Random& random, double sigma)
{
    const CalibrationScene left = makeScene(rig.camera1, views, random, sigma);
    const Ptr<RefractiveCamera> bare2 = RefractiveCamera::create(rig.camera2->cameraMatrix(), rig.camera2->distCoeffs());
    StereoScene scene;
    scene.object = left.object;
    scene.refracted1 = left.refracted;
    scene.direct1 = left.direct;
    scene.rvecs = left.rvecs;
    scene.tvecs = left.tvecs;
    for (int i = 0; i < views; i++)
    {
        Matx33d inCamera1;
        Vec3d rvec2;
        Rodrigues(left.rvecs[i], inCamera1);
        Rodrigues(rig.R*inCamera1, rvec2);
        const Vec3d tvec2 = rig.R*left.tvecs[i] + rig.T;
        scene.refracted2.push_back(seen(left.object[i], rvec2, tvec2, rig.camera2, random, sigma));
        scene.direct2.push_back(seen(left.object[i], rvec2, tvec2, bare2, random, sigma));
    }
    return scene;
}

double calibrate(const StereoScene& scene, StereoRig& rig, int flags, OutputArray covariance = noArray())
{
    const GlassRigResult result = stereoCalibrateGlass(scene.object, scene.direct1, scene.refracted1, scene.direct2, scene.refracted2,
                                                       rig.camera1, rig.camera2, rig.R, rig.T, noArray(), noArray(),
                                                       GlassRigOptions(flags));
    if (covariance.needed())
        result.covariance.copyTo(covariance);
    return result.rms;
}

GlassWindow pane(double distance = 0) { return GlassWindow({ 0, 0, 1 }, 20, 1.5437, distance); }

double normalError(const StereoRig& a, const StereoRig& b)
{
    return std::max(angleBetween(a.camera1->window().normal, b.camera1->window().normal),
                    angleBetween(a.camera2->window().normal, b.camera2->window().normal));
}

} // namespace

TEST_CASE("Two windows of a rig from perfect data, with pairs and without", "[stereo_glass]")
{
    Random random(400);
    CAPTURE(seed());
    const StereoRig truth = paperRig();
    StereoScene scene = makeStereoScene(truth, 6, random, 0);
    for (bool paired : { true, false })
    {
        if (!paired)
            scene.direct1 = scene.direct2 = PixelViews();
        StereoRig found = withWindows(truth, pane(), pane());
        CHECK(calibrate(scene, found, 0) < 1e-6);
        CHECK(normalError(found, truth) < 1e-4);
        CHECK(found.R == truth.R);
        CHECK(found.T == truth.T);
    }
}

TEST_CASE("R and T are found from crude values, and from wrong ones", "[stereo_glass]")
{
    const StereoRig truth = paperRig();
    for (int trial = 0; trial < trials(40); trial++)
    {
        Random random(4100 + trial);
        const StereoScene scene = makeStereoScene(truth, 6, random, 0.1);
        StereoRig start = withWindows(truth, pane(), pane());
        const double angles[] = { 0.05, 0.1, 0.2, 1 }, factors[] = { 1, 0, -1, 4 };
        Matx33d turn;
        Rodrigues(random.vector(angles[trial % 4]), turn);
        start.R = turn*truth.R;
        start.T = factors[trial/4 % 4]*truth.T + random.vector(30);
        for (int flags : { (int)GLASS_FREE_EXTRINSICS, GLASS_FREE_EXTRINSICS | GLASS_ROBUST })
        {
            StereoRig found = start;
            CAPTURE(trial, flags, start.R, start.T, seed());
            CHECK(calibrate(scene, found, flags) < 0.17);
            CHECK(norm(found.R - truth.R) < 2e-3);
            CHECK(norm(found.T - truth.T) < 1.5);
        }
    }
}

TEST_CASE("R and T are found with the windows", "[stereo_glass]")
{
    Random random(410);
    CAPTURE(seed());
    const StereoRig truth = paperRig();
    const StereoScene scene = makeStereoScene(truth, 8, random, 0);
    StereoRig found = withWindows(truth, pane(), pane());
    Rodrigues(Vec3d(0.02, 0.25, -0.01), found.R);
    found.T += Vec3d(5, -4, 3);
    CHECK(calibrate(scene, found, GLASS_FREE_EXTRINSICS) < 1e-6);
    CHECK(norm(found.R - truth.R) < 1e-6);
    CHECK(norm(found.T - truth.T) < 1e-3);
}

TEST_CASE("One pane for both cameras", "[stereo_glass]")
{
    Random random(420);
    CAPTURE(seed());
    StereoRig truth = paperRig();
    GlassWindow window({ -0.15, 0.05, 1 }, 12, 1.52, 70);
    const auto check = [&](const StereoRig& found)
    {
        CHECK(normalError(found, truth) < 1e-4);
        CHECK(norm(found.R*found.camera1->window().normal - found.camera2->window().normal) < 1e-12);
        CHECK(found.camera2->window().thickness == found.camera1->window().thickness);
    };

    SECTION("in air")
    {
        truth.camera1->setWindow(window);
        sharePane(truth);
        const StereoScene scene = makeStereoScene(truth, 6, random, 0);
        window.normal = Vec3d(0, 0, 1);
        StereoRig found = withWindows(truth, window, GlassWindow());
        CHECK(calibrate(scene, found, GLASS_SHARED_WINDOW) < 1e-6);
        check(found);
    }
    SECTION("seen through by camera 2 only")
    {
        truth.camera1->setWindow(window);
        sharePane(truth);
        StereoScene scene = makeStereoScene(truth, 6, random, 0);
        scene.refracted1 = PixelViews();
        window.normal = Vec3d(0, 0, 1);
        StereoRig found = withWindows(truth, window, GlassWindow());
        CHECK(calibrate(scene, found, GLASS_SHARED_WINDOW) < 1e-6);
        check(found);
    }
    SECTION("whose faces are not parallel, by so much as is given")
    {
        window.wedge.push_back(Vec2d(2e-3, -1e-3));
        truth.camera1->setWindow(window);
        truth.camera2->setWindow(windowInFrame(window, truth.R, truth.T));
        const StereoScene scene = makeStereoScene(truth, 6, random, 0);
        const GlassWindow given = window;
        window.normal = Vec3d(0, 0, 1);
        StereoRig found = withWindows(truth, window, GlassWindow());
        CHECK(calibrate(scene, found, GLASS_SHARED_WINDOW) < 1e-6);
        CHECK(normalError(found, truth) < 1e-4);
        CHECK(found.camera1->window().wedge == given.wedge);
        const GlassWindow second = found.camera2->window(), expected = truth.camera2->window();
        CHECK(std::abs(expected.thickness[0] - 12) > 0.05);         // along an axis of its own
        CHECK(std::abs(second.thickness[0] - expected.thickness[0]) < 1e-5);
        CHECK(norm(second.wedge[0] - expected.wedge[0]) < 1e-8);
    }
    SECTION("before water, distance free, with R and T")
    {
        window.outerIndex = 1.333;
        truth.camera1->setWindow(window);
        sharePane(truth);
        const StereoScene scene = makeStereoScene(truth, 8, random, 0);
        window.normal = Vec3d(0, 0, 1);
        window.distance = 40;
        StereoRig found = withWindows(truth, window, GlassWindow());
        found.T += Vec3d(2, -1, 1);
        CHECK(calibrate(scene, found, GLASS_SHARED_WINDOW | GLASS_FREE_DISTANCE | GLASS_FREE_EXTRINSICS) < 1e-5);
        check(found);
        CHECK(found.camera1->window().distance == Approx(70).epsilon(1e-5));
        CHECK(found.camera2->window().distance == Approx(truth.camera2->window().distance).epsilon(1e-5));
    }
}

TEST_CASE("A sealed rig: lens, R, T and both normals from glass-only views", "[stereo_glass]")
{
    Random random(430);
    CAPTURE(seed());
    const StereoRig truth = paperRig();
    StereoScene scene = makeStereoScene(truth, 25, random, 0);
    scene.direct1 = scene.direct2 = PixelViews();
    StereoRig found = withWindows(truth, pane(), pane());
    found.camera1->setLensParameters(std::vector<double>{ 2430, 2430, 640, 505, -0.4, 0.4, 0, 0 });
    found.camera2->setLensParameters(std::vector<double>{ 2450, 2450, 650, 480, -0.4, 0.4, 0, 0 });
    found.T += Vec3d(2, -1, 1);
    CHECK(calibrate(scene, found, GLASS_FREE_INTRINSICS | GLASS_FIX_TANGENT_DIST | GLASS_FREE_EXTRINSICS) < 1e-4);
    CHECK(normalError(found, truth) < 0.1);
    CHECK(norm(found.T - truth.T) < 0.05);
}

TEST_CASE("The covariance of a rig covers its errors", "[stereo_glass]")
{
    const int runs = 100;
    double mahalanobis = 0;
    for (int run = 0; run < runs; run++)
    {
        Random random(4400 + run);
        StereoRig truth = paperRig();
        GlassWindow window({ -0.15, 0.05, 1 }, 12, 1.52, 70, 1.333);
        truth.camera1->setWindow(window);
        sharePane(truth);
        const StereoScene scene = makeStereoScene(truth, 3, random, 0.1);
        StereoRig found = withWindows(truth, window, GlassWindow());
        Mat covariance, inverse;
        calibrate(scene, found, GLASS_SHARED_WINDOW | GLASS_FREE_DISTANCE | GLASS_FREE_EXTRINSICS, covariance);
        // 16 parameters of camera 1; of camera 2: lens 8, normal 3, distance, 4 more; then rvec, T
        REQUIRE(covariance.size() == Size(38, 38));
        Mat error(0, 1, CV_64F);
        const int camera2 = 16 + 8;
        const Vec3d normal = found.camera2->window().normal - truth.camera2->window().normal, T = found.T - truth.T;
        const double distance = found.camera2->window().distance - truth.camera2->window().distance;
        for (int i = 0; i < 3; i++)
            error.push_back(normal[i]);
        error.push_back(distance);
        for (int i = 0; i < 3; i++)
            error.push_back(T[i]);
        const int rows[] = { camera2, camera2 + 1, camera2 + 2, camera2 + 3, 35, 36, 37 };
        Mat part(7, 7, CV_64F);
        for (int i = 0; i < 7; i++)
            for (int j = 0; j < 7; j++)
                part.at<double>(i, j) = covariance.at<double>(rows[i], rows[j]);
        invert(part, inverse, DECOMP_SVD);
        mahalanobis += Mat(error.t()*inverse*error).at<double>(0)/runs;
    }
    CAPTURE(mahalanobis, seed());
    CHECK(mahalanobis == Approx(6).epsilon(0.2));       // chi^2: normal 2, distance 1, T 3
}

TEST_CASE("stereoCalibrateGlass refuses", "[stereo_glass]")
{
    Random random(450);
    StereoRig rig = paperRig();
    const StereoScene scene = makeStereoScene(rig, 4, random, 0.1);
    const auto why = [&](const StereoScene& s, int flags) { return thrown([&] { calibrate(s, rig, flags); }); };

    CHECK_THAT(why(scene, GLASS_FREE_DISTANCE), Catch::Contains("GLASS_FREE_DISTANCE"));
    StereoScene less = scene;
    less.refracted2.clear();
    CHECK_THAT(why(less, 0), Catch::Contains("imagePointsRefracted2"));
    less = scene;
    less.direct1.pop_back();
    CHECK_THAT(why(less, 0), Catch::Contains("imagePointsDirect1 has 3 views"));
    StereoRig same = rig;
    same.camera2 = same.camera1;
    CHECK_THAT(thrown([&] { calibrate(scene, same, 0); }), Catch::Contains("one object"));

    // no moment seen by both: nothing ties camera 2 to camera 1
    less = scene;
    for (int i = 0; i < 2; i++)
    {
        less.refracted1[i].clear();
        less.direct1[i].clear();
        less.refracted2[2 + i].clear();
        less.direct2[2 + i].clear();
    }
    CHECK_THAT(why(less, GLASS_FREE_EXTRINSICS), Catch::Contains("do not determine R and T"));

    // a pane so near and so tilted that camera 2 would stick through it
    rig.camera1->setWindow(GlassWindow({ 0.3, 0, 1 }, 20, 1.5437, 1));
    const StereoScene tilted = makeStereoScene(rig, 4, random, 0.1);
    rig.camera1->setWindow(GlassWindow({ 0.3, 0, 1 }, 20, 1.5437, 1, 1.333));
    CHECK_THAT(why(tilted, GLASS_SHARED_WINDOW), Catch::Contains("camera 2 lies beyond the window"));
}
