// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Cameras in tubes, calibrated: a point of the axis and its direction are free together, as four parameters.
#include "round_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const int CENTER = 8, AXIS = 11, COUNT = 19;      // rows of a camera: 8 of the lens
const double SIGMA = 0.1;

} // namespace

TEST_CASE("Two cameras in one tube are calibrated together", "[tube][calibrate]")
{
    Random random(6702);
    CAPTURE(seed());
    const RigTruth truth = roundRig(tubeAt, 2, true, 1.333, { 5, -4, 9 }, random, 0.02);
    RigCall call = callFromCentre(truth, makeRigScene(truth, 6, random, 0), true);
    CHECK(call.run(GLASS_FREE_EXTRINSICS) < 1e-6);
    for (int c = 0; c < 2; c++)
    {
        CHECK(placeErrors(call, truth, c)[0] < 1e-4);
        CHECK(placeErrors(call, truth, c)[1] < 1e-6);
        for (int i = 0; i < 3; i++)
            CHECK(call.stdDeviations.at<double>(c*COUNT + AXIS + i) > 0);
    }
}

TEST_CASE("The jacobian of a calibrated tube is that of the point of its axis that is returned", "[tube][calibrate]")
{
    CAPTURE(seed());
    Random random(6705);
    const RigTruth truth = roundRig(tubeAt, 1, false, 1.333, { 5, -4, 9 }, random);
    RigCall call = callFromCentre(truth, makeRigScene(truth, 4, random, SIGMA), true);
    GlassWindow window = call.cameras[0]->window();
    window.center += 50*window.axis;
    call.cameras[0]->setWindow(window);
    std::vector<Vec3d> rvecs, tvecs;
    Mat deviations, covariance, errors, jacobian, byProjection;
    calibrateGlass(call.object, call.direct[0], call.refracted[0], call.cameras[0], rvecs, tvecs, deviations, covariance, errors,
                   jacobian, 0);
    const int n = (int)call.object[0].size();
    REQUIRE(jacobian.rows == 4*n*(int)call.object.size());
    refractiveProjectPoints(call.object[1], rvecs[1], tvecs[1], call.cameras[0], noArray(), noArray(), byProjection);
    const Mat rows = jacobian.rowRange(6*n, 8*n);           // view 1 through the window
    CHECK(largestDifference(rows.colRange(CENTER, AXIS + 3), byProjection.colRange(6 + CENTER, 6 + AXIS + 3)) < 1e-7);
}

TEST_CASE("A tube's center is where its axis is nearest to the camera, and its covariance is of that point", "[tube][calibrate]")
{
    const int TRIALS = trials(8);
    const bool shared = GENERATE(false, true);
    double ofCenters = 0, ofPlaces = 0;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        Random random(6710 + trial);
        CAPTURE(shared, trial, seed());
        const RigTruth truth = roundRig(tubeAt, 2, shared, 1.333, { 5, -4, 9 }, random, shared ? 0.02 : 0.2);
        RigCall call = callFromCentre(truth, makeRigScene(truth, 4, random, SIGMA), true);
        for (const Ptr<RefractiveCamera>& camera : call.cameras)        // any point of the axis will do to begin with
        {
            GlassWindow window = camera->window();
            window.center += random.uniform(-50, 50)*window.axis;
            camera->setWindow(window);
        }
        call.run(GLASS_FREE_EXTRINSICS);
        for (int c = 0; c < 2; c++)
        {
            const GlassWindow found = call.cameras[c]->window();
            REQUIRE(std::abs(found.axis.dot(found.center)) < 1e-9);
            const int before = c*COUNT;
            const Matx33d ofCenter(Mat(call.covariance(Rect(before + CENTER, before + CENTER, 3, 3)).clone()).ptr<double>());
            const Matx33d ofAxis(Mat(call.covariance(Rect(before + AXIS, before + AXIS, 3, 3)).clone()).ptr<double>());
            // As the axis turns by da, the nearest point moves along it by -center.da.
            const double along = found.axis.dot(ofCenter*found.axis), byTurn = found.center.dot(ofAxis*found.center);
            CHECK(along == Approx(byTurn).epsilon(1e-6));
            const std::vector<double> errors = windowErrors(found, truth.cameras[c]->window());
            for (int k = 0; k < 3; k++)
            {
                const double sigma = call.stdDeviations.at<double>(before + CENTER + k);
                CHECK(sigma == Approx(std::sqrt(ofCenter(k, k))));
                ofCenters += errors[k]*errors[k]/(sigma*sigma)/(6*TRIALS);
            }
            ofPlaces += overStated(errors, call.covariance, placeRows(found, before), before)/(2*4*TRIALS);
        }
    }
    CAPTURE(shared, seed());
    printNumber(shared ? "centers of a shared tube, squares over stated" : "centers of tubes, squares over stated", ofCenters, "");
    // Means of chi^2 over its freedom: a camera has four of a place, and two cameras of one tube hardly more.
    const double spread = 3*std::sqrt(2./(TRIALS*(shared ? 4 : 8)));
    CHECK(ofPlaces < 1 + spread);
    CHECK(ofPlaces > 1 - spread);
    CHECK(ofCenters < 1 + 1.5*spread);
}

TEST_CASE("What is known of a tube's place is a prior", "[tube][calibrate]")
{
    Random random(6703);
    CAPTURE(seed());
    const RigTruth truth = roundRig(tubeAt, 1, false, 1., { 4, -3, 6 }, random);
    const RigScene scene = makeRigScene(truth, 1, random, SIGMA);
    const int at[] = { CENTER, CENTER + 2, AXIS, AXIS + 2 };        // across the axis, about
    std::vector<double> last(4, 0);
    for (double known : { 0.01, 0.3, 3. })      // mm; of the axis, a fiftieth radian for each
    {
        RigCall call = callFromCentre(truth, scene, true);
        call.cameras[0]->setWindow(truth.cameras[0]->window());
        Mat prior = Mat::diag(Mat(COUNT, 1, CV_64F, Scalar(NaN)));
        for (int i = 0; i < 3; i++)
        {
            prior.at<double>(CENTER + i, CENTER + i) = known*known;
            prior.at<double>(AXIS + i, AXIS + i) = known*known/2500;
        }
        call.run(0, { prior });
        const std::vector<double> errors = windowErrors(call.cameras[0]->window(), truth.cameras[0]->window());
        for (int i = 0; i < 4; i++)
        {
            const double found = call.stdDeviations.at<double>(at[i]);
            CAPTURE(known, at[i], found);
            CHECK(found > last[i]);
            CHECK(found <= 1.000001*known/(i < 2 ? 1 : 50));
            CHECK(std::abs(errors[at[i] - LENS_PARAMETERS]) < 4*found);
            last[i] = found;
        }
    }
}

TEST_CASE("What images cannot tell of a tube is refused, by its name", "[tube][calibrate]")
{
    Random random(6704);
    CAPTURE(seed());
    const RigTruth truth = roundRig(tubeAt, 1, false, 1.333, { 4, -3, 6 }, random);
    const RigScene scene = makeRigScene(truth, 8, random, SIGMA);
    const auto refusal = [&](const GlassWindow& window, int flags)
    {
        RigCall call = callFromCentre(truth, scene, true);
        call.cameras[0]->setWindow(window);
        return thrown([&] { call.run(flags); });
    };
    const GlassWindow tube = tubeAt({ 4, -3, 6 }, 1.333);
    CHECK_THAT(refusal(tube, GLASS_FREE_DISTANCE), Catch::Contains("GLASS_FREE_RADIUS"));
    CHECK_THAT(refusal(tube, GLASS_FREE_WEDGE), Catch::Contains("no wedge"));
    CHECK_THAT(refusal(tube, GLASS_FREE_CURVATURE), Catch::Contains("GLASS_FREE_RADIUS"));
    // Nothing of a tube but its axis is seen that does not refract.
    GlassWindow none = tube;
    none.thickness.clear();
    none.index.clear();
    none.outerIndex = 1;
    CHECK_THAT(refusal(none, 0), Catch::Contains("does not refract"));
}

TEST_CASE("A wand in front of two tubes", "[tube][bundle]")
{
    Random random(6705);
    CAPTURE(seed());
    const RigTruth truth = roundRig(tubeAt, 2, false, 1.333, { 5, -4, 9 }, random);
    for (double sigma : { 0., SIGMA })
    {
        const BundleScene scene = makeWandScene(truth, 40, random, sigma);
        BundleCall call(truth, scene, random);
        for (const Ptr<RefractiveCamera>& camera : call.cameras)
            camera->setWindow(tubeAt(Vec3d(), 1.333));
        call.run(GLASS_FREE_EXTRINSICS);
        for (int c = 0; c < 2; c++)
        {
            const GlassWindow exact = truth.cameras[c]->window();
            const std::vector<double> errors = windowErrors(call.cameras[c]->window(), exact);
            CAPTURE(sigma, c, errors);
            if (sigma == 0)
                CHECK(norm(Mat(errors).rowRange(0, 6)) < 1e-6);
            else                                // chi^2 of 4: 1 in 15000
                CHECK(overStated(errors, call.covariance, placeRows(exact, c*COUNT), c*COUNT) < 25);
        }
    }
}
