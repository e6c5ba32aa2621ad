// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What a wrong value does to measured points, against calibrations from observations that are wrong in that way.
#include "assess/tolerance.hpp"
#include "fitted_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

//! One camera, eight pairs without noise, all boards moved between the direct and the glass image.
RigData pairsMovedBy(const RigModel& rig, const Vec3d& shift)
{
    scenes::Random random(1010);
    RigData data = dataOf(rig);
    for (int i = 0; i < 8; i++)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660)), rvec = random.vector(0.4);
        data.views.push_back(observe(rig, board(6, 5), rvec, tvec, true, 0., random));
        data.views.back().glass[0] = observe(rig, board(6, 5), rvec, tvec + shift, false, 0., random).glass[0];
    }
    return data;
}

RigCalibration calibrated(const RigModel& rig, const Vec3d& shift)
{
    return fittedRig(rig, pairsMovedBy(rig, shift));
}

} // namespace

TEST_CASE("What a nudge between direct and glass images does is told, and is much", "[tolerance]")
{
    const RigModel rig = paperRig(1);
    const RigCalibration still = calibrated(rig, Vec3d());
    const std::vector<Tolerance> tolerances = analyseTolerances(still, 1., true);
    REQUIRE(tolerances.size() == 6);
    const Tolerance& nudge = tolerances[3];
    CHECK_THAT(nudge.what, Catch::Contains("moved by 0.1 mm"));
    REQUIRE(nudge.done);

    // A calibration of pairs that were nudged: its normal is wrong by most of a degree, its points by what was said at most.
    double worst = 0., turned = 0.;
    for (const Vec3d& shift : {Vec3d(0.1, 0, 0), Vec3d(0, 0.1, 0), Vec3d(0.07, -0.07, 0)})
    {
        const RigCalibration nudged = calibrated(rig, shift);
        const Ptr<RefractiveCamera> is = rig.cameras[0], found = nudged.fit.rig.cameras[0];
        turned = std::max(turned, std::acos(is->window().normal.dot(found->window().normal))*180./CV_PI);
        std::vector<Point2d> pixels{{0, 0}, {640, 512}, {1279, 0}, {0, 1023}, {1279, 1023}};
        std::vector<Point3d> right, wrong;
        refractivePointsOnPlane(pixels, right, is, Vec4d(0, 0, 1, workingDepth(still, 0)[2]));
        refractivePointsOnPlane(pixels, wrong, found, Vec4d(0, 0, 1, workingDepth(still, 0)[2]));
        for (size_t i = 0; i < right.size(); i++)
            worst = std::max(worst, norm(wrong[i] - right[i]));
    }
    CHECK(turned > 0.5);
    CHECK(worst < 1.05*nudge.worst);
    CHECK(worst > 0.8*nudge.worst);

    RigCalibration glassOnly = still;
    for (View& view : glassOnly.data.views)
        view.direct[0].clear();
    CHECK(analyseTolerances(glassOnly, 1., true).size() == 5);
}

TEST_CASE("What a wrong square and a bent board do is told", "[tolerance]")
{
    const RigModel rig = paperRig(2);
    RigData data = dataOf(rig), ofBent = data;
    std::vector<Point3d> bent = board(6, 5);        // as seen: 0.1 mm from corner to middle
    for (Point3d& X : bent)
        X.z = 0.1*(1. - (X.x*X.x + X.y*X.y)/(97.5*97.5 + 78.*78.));
    scenes::Random random(1020);
    for (int i = 0; i < 8; i++)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660));
        const Vec3d rvec = random.vector(0.4);
        data.views.push_back(observe(rig, board(6, 5), rvec, tvec, true, 0., random));
        ofBent.views.push_back(observe(rig, bent, rvec, tvec, true, 0., random));
        ofBent.views.back().objectPoints = board(6, 5);        // taken for flat
    }
    const RigCalibration right = fittedRig(rig, data);
    const std::vector<Tolerance> tolerances = analyseTolerances(right, 1., true);
    REQUIRE(tolerances.size() >= 2);
    const Tolerance &square = tolerances[tolerances.size() - 2], &bow = tolerances.back();
    CHECK(square.what == "square wrong by 0.1 %");
    CHECK(bow.what == "board bent by 0.1 mm");
    REQUIRE((square.done && bow.done));

    // Two cameras measure all lengths by the square.
    CHECK(square.lengths == Approx(1e-3).epsilon(0.1));
    CHECK(square.rms == Approx(0.6).epsilon(0.2));

    // A calibration of images of a bent board, taken for flat.
    const RigModel found = fitImages(ofBent, rig, allViews(ofBent), 0).rig;
    double worst = 0.;
    for (const Point3d& X : {Point3d(0, 0, 600), Point3d(60, 40, 650), Point3d(-60, -40, 560), Point3d(50, -60, 610)})
    {
        std::vector<Point2d> seen[2];
        Vec3d rvec;
        Rodrigues(rig.extrinsics[1].R, rvec);
        refractiveProjectPoints(std::vector<Point3d>{X}, Vec3d(), Vec3d(), rig.cameras[0], seen[0]);
        refractiveProjectPoints(std::vector<Point3d>{X}, rvec, rig.extrinsics[1].T, rig.cameras[1], seen[1]);
        std::vector<Point3d> point;
        triangulateRefractive(found.cameras[0], found.cameras[1], found.extrinsics[1].R, found.extrinsics[1].T, seen[0], seen[1], point);
        worst = std::max(worst, norm(point[0] - X));
    }
    CAPTURE(worst, bow.rms, bow.worst, bow.lengths);
    CHECK(worst > 0.5*bow.rms);
    CHECK(worst < 1.2*bow.worst);
}

TEST_CASE("An index of a named material is wrong by what its name leaves open", "[tolerance]")
{
    RigCalibration c = calibrated(paperRig(1), Vec3d());
    const Tolerance number = analyseTolerances(c, 1., true)[1];
    REQUIRE((number.done && number.what == "index wrong by 0.001"));
    GivenIndex given{1.5437, "N-BK7"};
    given.deviation = 0.0054;
    c.options.layers = {given};
    const Tolerance name = analyseTolerances(c, 1., true)[1];
    CHECK(name.what == "index wrong by 0.0054 (N-BK7, light of 450 to 650 nm)");
    REQUIRE(name.done);
    CHECK(name.rms == Approx(5.4*number.rms).epsilon(0.02));
}
