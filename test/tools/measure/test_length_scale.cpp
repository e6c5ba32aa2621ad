// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Lengths that contradict a target: is the stated deviation of their mean ratio true, and is a rig that changed told by it?
#include "measure/measured_doubts.hpp"
#include "../accept/acceptance_scene.hpp"

using namespace cv;
using namespace tools;
using namespace acceptance_scene;

namespace {

const double TARGET_STD = USUAL_SQUARE_STD;

//! Boards of a wrong square, seen by a rig and measured with a calibration. @param targetStd how wrong the square may be, relative
LengthScale seenBy(const RigModel& truth, const Calibration& calibration, scenes::Random& random, double targetError,
                   double targetStd = TARGET_STD)
{
    std::vector<View> views;
    std::vector<Measurement> results;
    for (int k = 0; k < 3; k++)
    {
        View view;
        view.objectPoints = board(6, 5);
        for (int i = 0; i < 30; i++)
            for (int next : {i % 6 < 5 ? i + 1 : -1, i < 24 ? i + 6 : -1})
                if (next >= 0)
                    view.neighbours.push_back({i, next});
        const RigidTransform pose = transformOf(Vec3d(0.2, 0.1 - 0.2*k, 0.05), Vec3d(-20, 10, 600 + 30*k));
        std::vector<Point3d> points;
        for (const Point3d& X : view.objectPoints)
            points.push_back(Point3d(pose.apply(Vec3d(X*(1. + targetError)))));
        views.push_back(view);
        results.push_back(measureRig(calibration, pixelsOf(truth, points, SIGMA, random), SIGMA));
    }
    return lengthScaleOf(calibration, views, results, SIGMA, targetStd);
}

} // namespace

TEST_CASE("The mean ratio of lengths is as far from 1 as is stated", "[length_scale]")
{
    const Calibration calibration = calibrated();
    const TrueRigs rigs(calibration);
    scenes::Random random(7710);
    std::cout << "seed " << scenes::seed() << '\n';
    const int trials = scenes::trials(400);
    for (double targetStd : {TARGET_STD, 0.})       // the board, then the calibration, is most of it
    {
        double squares = 0., most = 0.;
        for (int trial = 0; trial < trials; trial++)
        {
            const LengthScale scale = seenBy(rigs.draw(random), calibration, random, random.normal(targetStd), targetStd);
            squares += std::pow(scale.deviations(), 2);
            most = std::max(most, scale.deviations());
        }
        const double rms = std::sqrt(squares/trials);
        std::cout << format("[numbers] mean ratio of lengths, board known to %g, %d rigs: error over stated %.3f RMS, at most %.2f",
                            targetStd, trials, rms, most) << std::endl;
        CHECK(rms > 0.88);
        CHECK(rms < 1.12);
        CHECK(most < 5.);
    }
}

TEST_CASE("A camera that turned and a wrong square show in lengths", "[length_scale]")
{
    const Calibration calibration = calibrated();
    scenes::Random random(7711);
    std::cout << "seed " << scenes::seed() << '\n';
    RigModel turned = modelOf(calibration);
    turned.extrinsics[1].R = rotationMatrix(Vec3d(0, 0.1*CV_PI/180, 0))*turned.extrinsics[1].R;
    CHECK(seenBy(turned, calibration, random, 0.).deviations() > 5.);
    CHECK(seenBy(modelOf(calibration), calibration, random, 0.01).deviations() > 5.);
    CHECK(seenBy(modelOf(calibration), calibration, random, 0.).deviations() < 5.);
}

TEST_CASE("Lengths on a plane are judged by one camera", "[length_scale]")
{
    const Calibration calibration = calibrated();
    scenes::Random random(7713);
    std::cout << "seed " << scenes::seed() << '\n';
    View view;
    view.objectPoints = board(6, 5);
    for (int i = 0; i < 24; i++)
        view.neighbours.push_back({i, i + 6});
    std::vector<Point3d> points;
    for (const Point3d& X : view.objectPoints)
        points.push_back(X + Point3d(-90, -70, 620));
    const std::vector<Point2d> pixels = pixelsOf(modelOf(calibration), points, SIGMA, random)[0];
    for (double z : {620., 640.})
    {
        const Vec4d plane(0, 0, 1, z);
        const LengthScale scale = lengthScaleOf(calibration, {view}, {measureOnPlane(calibration, pixels, plane, SIGMA)}, SIGMA, TARGET_STD,
                                                plane);
        CAPTURE(z, scale.ratio, scale.sigma);
        CHECK((scale.deviations() < 5.) == (z == 620.));
    }
}

TEST_CASE("Of lengths that nothing is known of nothing is said", "[length_scale]")
{
    Calibration calibration = calibrated();
    scenes::Random random(7712);
    std::cout << "seed " << scenes::seed() << '\n';
    const LengthScale none = lengthScaleOf(calibration, {}, {}, SIGMA, TARGET_STD);
    CHECK(none.ratio == 1.);
    CHECK(none.deviations() == 0.);
    calibration.covariance.release();
    const LengthScale unknown = seenBy(modelOf(calibration), calibration, random, 0.1);
    CHECK(unknown.ratio == Approx(1.1).epsilon(0.01));
    CHECK(std::isnan(unknown.sigma));
    CHECK(unknown.deviations() == 0.);
}
