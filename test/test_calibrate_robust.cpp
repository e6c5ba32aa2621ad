// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Wrong points and moved targets: found, left out, named.
#include "rig_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

typedef std::vector<std::vector<uchar> > Masks;     // per view

//! Two cameras of the paper, pairs.
struct Rig
{
    RigTruth truth = paperStereo();
    RigScene scene;
    Rig(int views, unsigned salt, double sigma = 0.1)
    {
        Random random(salt);
        scene = makeRigScene(truth, views, random, sigma);
    }
    double errorOf(const RigCall& call, int c) const
    { return angleBetween(call.cameras[c]->window().normal, truth.cameras[c]->window().normal); }
};

int countStatus(const Mat& status, int which) { return countNonZero(status == which); }

} // namespace

TEST_CASE("30 % of the corners displaced: the wrong ones are left out, the normal is as from the rest", "[robust]")
{
    for (int run = 0; run < 5; run++)
    {
        Rig rig(6, 700 + run);
        Random random(750 + run);
        CAPTURE(run, seed());
        RigScene clean = rig.scene;
        std::vector<Masks> refracted, direct;
        for (int c = 0; c < 2; c++)
        {
            refracted.push_back(displace(rig.scene.refracted[c], 0.3, random));
            direct.push_back(displace(rig.scene.direct[c], 0.3, random));
            clean.refracted[c] = without(clean.refracted[c], refracted[c]);
            clean.direct[c] = without(clean.direct[c], direct[c]);
        }
        RigCall call(rig.truth, rig.scene, true), best(rig.truth, clean, true);
        const double rms = call.run(GLASS_ROBUST);
        best.run(0);
        CHECK(rms == Approx(0.1*std::sqrt(2.)).epsilon(0.05));
        CHECK(countStatus(call.imageStatus, GLASS_IMAGE_USED) == 24);
        int wrongKept = 0, rightLost = 0;
        for (int view = 0; view < 6; view++)
            for (int column = 0; column < 4; column++)
                for (int i = 0; i < 30; i++)
                {
                    const bool isWrong = (column % 2 == 0 ? direct : refracted)[column/2][view][i];
                    const bool isKept = call.inliers[4*view + column].at<uchar>(i) != 0;
                    wrongKept += isWrong && isKept;
                    rightLost += !isWrong && !isKept;
                }
        CHECK(wrongKept == 0);
        CHECK(rightLost <= 2);
        for (int c = 0; c < 2; c++)
            CHECK(angleBetween(call.cameras[c]->window().normal, best.cameras[c]->window().normal) < 0.01);
    }
}

TEST_CASE("Clean data lose next to nothing, with pairs and without", "[robust][slow]")
{
    for (bool paired : { true, false })
    {
        Rig rig(12, 710);
        CAPTURE(paired, seed());
        RigCall robust(rig.truth, rig.scene, paired), all(rig.truth, rig.scene, paired);
        robust.run(GLASS_ROBUST);
        all.run(0);
        int lost = 0;
        for (const Mat& mask : robust.inliers)
            lost += (int)mask.total() - countNonZero(mask);
        CHECK(lost <= 2);
        const double sigma = std::sqrt(trace(all.covariance(Rect(8, 8, 3, 3)))[0])*180/CV_PI;
        CHECK(angleBetween(robust.cameras[0]->window().normal, all.cameras[0]->window().normal) < sigma);
        CHECK(largestDifference(robust.stdDeviations, all.stdDeviations) < 0.02*norm(all.stdDeviations, NORM_INF));
    }
    Rig perfect(4, 715, 0);
    RigCall call(perfect.truth, perfect.scene, true);
    CHECK(call.run(GLASS_ROBUST) < 1e-6);
    CHECK(countNonZero(call.inliers[0]) == 30);
}

TEST_CASE("A board that moved between the direct and the glass image is named", "[robust]")
{
    for (double shift : { 0.1, 1., 10. })      // mm
    {
        Rig rig(8, 720);
        Random random(721);
        CAPTURE(shift, seed());
        // View 5 is seen through the windows after the board was moved and turned a little.
        RigTruth truth = rig.truth;
        for (int c = 0; c < 2; c++)
        {
            Matx33d R, turned;
            Vec3d rvec;
            Rodrigues(rig.scene.rvecs[5], R);
            Rodrigues(Vec3d(0.002, -0.003, 0.001)*shift, turned);
            Rodrigues(truth.Rs[c]*turned*R, rvec);
            const Vec3d tvec = truth.Rs[c]*(rig.scene.tvecs[5] + Vec3d(shift, -shift, shift)) + truth.Ts[c];
            rig.scene.refracted[c][5] = seen(board(), rvec, tvec, truth.cameras[c], random, 0.1);
        }
        RigCall call(rig.truth, rig.scene, true);
        const double rms = call.run(GLASS_ROBUST);
        CHECK(rms == Approx(0.1*std::sqrt(2.)).epsilon(0.05));
        CHECK(countStatus(call.imageStatus, GLASS_IMAGE_MOVED) == 2);
        CHECK(call.imageStatus.at<uchar>(5, 0) == GLASS_IMAGE_MOVED);
        CHECK(call.imageStatus.at<uchar>(5, 2) == GLASS_IMAGE_MOVED);
        CHECK(rig.errorOf(call, 0) < 0.1);
        CHECK(rig.errorOf(call, 1) < 0.1);
    }
}

TEST_CASE("A board read the wrong way round, and an image of something else, are named", "[robust]")
{
    Rig rig(6, 730);
    Random random(731);
    CAPTURE(seed());
    std::reverse(rig.scene.refracted[1][2].begin(), rig.scene.refracted[1][2].end());
    for (Point2d& p : rig.scene.direct[0][4])
        p = Point2d(random.uniform(0, 1280), random.uniform(0, 1024));
    RigCall call(rig.truth, rig.scene, true);
    CHECK(call.run(GLASS_ROBUST) == Approx(0.1*std::sqrt(2.)).epsilon(0.05));
    CHECK(call.imageStatus.at<uchar>(2, 3) == GLASS_IMAGE_MOVED);
    CHECK(call.imageStatus.at<uchar>(4, 0) == GLASS_IMAGE_UNUSABLE);
    CHECK(countStatus(call.imageStatus, GLASS_IMAGE_USED) == 22);
    CHECK(std::isnan(call.perViewErrors.at<double>(4, 0)));
    REQUIRE(call.inliers[4*4].total() == 30);
    CHECK(countNonZero(call.inliers[4*4]) == 0);
}

TEST_CASE("A view of which nothing is left has no pose; the others serve", "[robust]")
{
    Rig rig(5, 740);
    Random random(741);
    for (int c = 0; c < 2; c++)
        for (PixelViews* views : { &rig.scene.refracted[c], &rig.scene.direct[c] })
            for (Point2d& p : (*views)[3])
                p = Point2d(random.uniform(0, 1280), random.uniform(0, 1024));
    RigCall call(rig.truth, rig.scene, true);
    CHECK(call.run(GLASS_ROBUST) < 0.16);
    CHECK(std::isnan(call.tvecs[3].at<double>(2)));
    CHECK(std::isfinite(call.tvecs[4].at<double>(2)));
    CHECK(countStatus(call.imageStatus, GLASS_IMAGE_UNUSABLE) == 4);
}

TEST_CASE("A wrong constant moves all views alike and is not taken for moved boards", "[robust]")
{
    Rig rig(8, 745);
    RigCall call(rig.truth, rig.scene, true);
    for (int c = 0; c < 2; c++)
    {
        GlassWindow window = call.cameras[c]->window();
        window.thickness[0] = 19.5;
        call.cameras[c]->setWindow(window);
    }
    call.run(GLASS_ROBUST);
    CHECK(countStatus(call.imageStatus, GLASS_IMAGE_USED) == 32);
}

TEST_CASE("A start far off does not make boards look moved", "[robust][slow]")
{
    for (unsigned salt : { 0u, 1u, 2u, 3u })
    {
        Random random(748 + salt);
        CAPTURE(seed(), salt);
        RigTruth truth = makeRig(4, { 0, 1, 2, 3 }, 1.333);
        for (const Ptr<RefractiveCamera>& camera : truth.cameras)
        {
            GlassWindow window = camera->window();
            window.distance *= 3;
            camera->setWindow(window);
        }
        const RigScene scene = makeRigScene(truth, 10, random, 0.1);
        RigCall call(truth, scene, true);
        for (const Ptr<RefractiveCamera>& camera : call.cameras)
        {
            GlassWindow window = camera->window();
            window.distance /= 14;
            camera->setWindow(window);
        }
        call.run(GLASS_FREE_DISTANCE | GLASS_FREE_INTRINSICS | GLASS_FREE_EXTRINSICS | GLASS_ROBUST);
        CHECK(countStatus(call.imageStatus, GLASS_IMAGE_USED) == 80);
    }
}

TEST_CASE("A robust fit of images of which most show something else refuses; flags = 0 takes all points", "[robust]")
{
    Rig rig(4, 750);
    Random random(751);
    for (int c = 0; c < 2; c++)
        for (int view = 0; view < 3; view++)
            for (Point2d& p : rig.scene.refracted[c][view])
                p = Point2d(random.uniform(0, 1280), random.uniform(0, 1024));
    for (int c = 0; c < 2; c++)
        rig.scene.direct[c] = PixelViews(4);
    RigCall call(rig.truth, rig.scene, true);
    CHECK_THAT(thrown([&] { call.run(GLASS_ROBUST); }), Catch::Contains("of 240 points fit"));

    Rig displaced(4, 755);
    for (int c = 0; c < 2; c++)
        displace(displaced.scene.refracted[c], 0.3, random);
    RigCall all(displaced.truth, displaced.scene, true);
    CHECK(all.run(0) > 2);
    CHECK(countNonZero(all.inliers[1]) == 30);
}
