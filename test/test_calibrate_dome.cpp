// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Cameras in domes, calibrated: from crude starts, at the Cramer-Rao bound, with errors as stated. The centre is free, as the normal
// of a pane is.
#include "round_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const int CENTER = 8, COUNT = 16;      // rows of a camera: 8 of the lens
const double SIGMA = 0.1;

RigTruth domeRig(int count, bool shared, double outerIndex, const Vec3d& center, Random& random, double apart = 0.2)
{
    return roundRig(domeAt, count, shared, outerIndex, center, random, apart);
}

double centerError(const RigCall& call, const RigTruth& truth, int c = 0)
{
    return norm(call.cameras[c]->window().center - truth.cameras[c]->window().center);
}

} // namespace

TEST_CASE("Two cameras in one dome are calibrated together", "[dome][calibrate]")
{
    Random random(6102);
    CAPTURE(seed());
    const RigTruth truth = domeRig(2, true, 1.333, { 5, -4, 9 }, random, 0.02);
    const RigScene scene = makeRigScene(truth, 6, random, 0);
    RigCall call = callFromCentre(truth, scene, true);
    CHECK(call.run(GLASS_FREE_EXTRINSICS) < 1e-6);
    for (int c = 0; c < 2; c++)
        CHECK(centerError(call, truth, c) < 1e-4);
    // Of the second camera the centre is stated in its own frame.
    const Mat own = call.covariance(Rect(CENTER, CENTER, 3, 3)), others = call.covariance(Rect(CENTER + COUNT, CENTER + COUNT, 3, 3));
    CHECK(trace(others)[0] > 0);
    CHECK(trace(own)[0] > 0);
}

TEST_CASE("What images cannot tell of a dome is refused, by its name", "[dome][calibrate]")
{
    Random random(6103);
    CAPTURE(seed());
    // In the centre no ray is refracted, whatever the radius.
    const RigTruth centred = domeRig(1, false, 1.333, Vec3d(), random);
    const RigScene scene = makeRigScene(centred, 8, random, SIGMA);
    for (int flag : { GLASS_FREE_RADIUS, GLASS_FREE_INDEX, GLASS_FREE_THICKNESS, GLASS_FREE_OUTER_INDEX })
    {
        RigCall call = callFromCentre(centred, scene, true);
        const char* const name = flag == GLASS_FREE_RADIUS ? "radius" : flag == GLASS_FREE_INDEX ? "index[0]" :
                                 flag == GLASS_FREE_THICKNESS ? "thickness[0]" : "outerIndex";
        CHECK_THAT(thrown([&] { call.run(flag); }), Catch::Contains(name));
    }
    RigCall known = callFromCentre(centred, scene, true);
    known.run(0);
    CHECK(centerError(known, centred) < 0.5);

    const auto refusal = [&](const GlassWindow& window, int flags)
    {
        RigCall call = callFromCentre(centred, scene, true);
        call.cameras[0]->setWindow(window);
        return thrown([&] { call.run(flags); });
    };
    const GlassWindow dome = domeAt({ 1, 2, 3 }, 1.333);
    CHECK_THAT(refusal(dome, GLASS_FREE_DISTANCE), Catch::Contains("GLASS_FREE_RADIUS"));
    CHECK_THAT(refusal(dome, GLASS_FREE_WEDGE), Catch::Contains("no wedge"));
    CHECK_THAT(refusal(dome, GLASS_FREE_CURVATURE), Catch::Contains("GLASS_FREE_RADIUS"));
    CHECK_THAT(refusal(paper::pane(), GLASS_FREE_RADIUS), Catch::Contains("no radius"));
    GlassWindow none = dome;
    none.thickness.clear();
    none.index.clear();
    none.outerIndex = 1;
    CHECK_THAT(refusal(none, 0), Catch::Contains("does not refract"));

    // Of two cameras in one dome the second is outside of it.
    RigTruth apart = domeRig(2, false, 1.333, { 1, 2, 3 }, random);
    const RigScene seen = makeRigScene(apart, 6, random, SIGMA);
    apart.windows = { 0, 0 };
    RigCall shared = callFromCentre(apart, seen, true);
    CHECK_THAT(thrown([&] { shared.run(0); }), Catch::Contains("beyond the window"));
}

TEST_CASE("A wand in front of two domes", "[dome][bundle]")
{
    Random random(6105);
    CAPTURE(seed());
    const RigTruth truth = domeRig(2, false, 1.333, { 5, -4, 9 }, random);
    for (double sigma : { 0., SIGMA })
    {
        const BundleScene scene = makeWandScene(truth, 40, random, sigma);
        BundleCall call(truth, scene, random);
        for (const Ptr<RefractiveCamera>& camera : call.cameras)
        {
            GlassWindow window = domeAt(Vec3d(), 1.333);
            camera->setWindow(window);
        }
        call.run(GLASS_FREE_EXTRINSICS);
        for (int c = 0; c < 2; c++)
        {
            const Vec3d error = call.cameras[c]->window().center - truth.cameras[c]->window().center;
            const int row = CENTER + c*COUNT;
            CAPTURE(sigma, c, error);
            if (sigma == 0)
                CHECK(norm(error) < 1e-6);
            else                                // chi^2 of 3: 1 in 15000
                CHECK(squaredMahalanobis({ error[0], error[1], error[2] }, call.covariance, { row, row + 1, row + 2 }) < 22);
        }
    }
}

TEST_CASE("A rig that is sealed in its domes", "[dome][calibrate]")
{
    Random random(6106);
    CAPTURE(seed());
    const RigTruth truth = domeRig(2, false, 1.333, { 5, -4, 9 }, random);
    const RigScene scene = makeRigScene(truth, ObjectViews(20, board()), random, 0, 400, 800);
    RigCall call = callFromCentre(truth, scene, false);
    for (const Ptr<RefractiveCamera>& camera : call.cameras)
    {
        std::vector<double> lens = camera->lensParameters();
        for (int i = 0; i < 4; i++)
            lens[i] = i < 2 ? 1.05*lens[i] : lens[i] + 15;
        camera->setLensParameters(lens);
    }
    CHECK(call.run(GLASS_FREE_INTRINSICS | GLASS_FREE_EXTRINSICS) < 1e-4);
    // A length behind the domes, as the rig measures it.
    std::vector<Point3d> points;
    triangulateRefractive(call.cameras[0], call.cameras[1], call.Rs[1], call.Ts[1], scene.refracted[0][0], scene.refracted[1][0], points);
    CHECK(std::abs(norm(points[1] - points[0]) - 39) < 1e-3);
}

TEST_CASE("What is known of a dome's centre is a prior", "[dome][calibrate]")
{
    Random random(6104);
    CAPTURE(seed());
    const RigTruth truth = domeRig(1, false, 1., { 4, -3, 6 }, random);
    const RigScene scene = makeRigScene(truth, 1, random, SIGMA);
    double last = 0;
    for (double sigma : { 0.01, 0.3, 3. })
    {
        RigCall call = callFromCentre(truth, scene, true);
        call.cameras[0]->setWindow(truth.cameras[0]->window());
        Mat prior = Mat::diag(Mat(COUNT, 1, CV_64F, Scalar(NaN)));
        for (int i = 0; i < 3; i++)
            prior.at<double>(CENTER + i, CENTER + i) = sigma*sigma;
        call.run(0, { prior });
        const double found = call.stdDeviations.at<double>(CENTER + 2);
        CAPTURE(sigma, found);
        CHECK(found > last);
        CHECK(found <= 1.000001*sigma);
        CHECK(std::abs(call.cameras[0]->window().center[2] - 6) < 4*found);
        last = found;
    }
}
