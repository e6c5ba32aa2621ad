// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/eigen_matrix.hpp"
#include "assess/change.hpp"
#include "assess/check_problem.hpp"
#include "assess/rig_check.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"
#include "measure/rig_vector.hpp"
#include "math/dense.hpp"
#include "paper_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

const double SIGMA = 0.1, FREEDOM = 500., FALSE_ALARM = 0.01;

//! A calibration from ten pairs at 0.1 px: its covariance for sigma = 0.1.
Mat calibratedCovariance(const RigModel& rig, const std::vector<Point3d>& object, scenes::Random& random)
{
    std::vector<std::vector<Point3d>> objects;
    std::vector<std::vector<Point2d>> direct, glass;
    double rms = 0.;
    Mat covariance;
    for (int i = 0; i < 10; i++)
    {
        const View view = observe(rig, object, random.vector(0.4), Vec3d(random.uniform(-30, 30), random.uniform(-20, 20),
                                                                         random.uniform(560, 660)), true, SIGMA, random);
        objects.push_back(object);
        direct.push_back(view.direct[0]);
        glass.push_back(view.glass[0]);
    }
    RigModel found = rig.clone();
    rms = calibrateGlass(objects, direct, glass, found.cameras[0], noArray(), noArray(), noArray(), covariance, noArray(),
                         noArray());
    return covariance*(2.*SIGMA*SIGMA/(rms*rms));
}

//! A rig as a calibration would have found it: its normal off by a draw from the covariance.
RigModel drawn(const RigModel& truth, const Mat& covariance, scenes::Random& random)
{
    const int at = columnsOf(truth, 0).normal;
    const SymmetricEigen eigen(toEigen(covariance(Rect(at, at, 3, 3))));
    RigModel rig = truth.clone();
    GlassWindow window = rig.cameras[0]->window();
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++)
            window.normal[axis] += eigen.vectors(axis, k)*random.normal(std::sqrt(std::max(0., eigen.values[k])));
    window.normal = normalize(window.normal);
    rig.cameras[0]->setWindow(window);
    return rig;
}

RigModel tilted(const RigModel& rig, double degrees, double azimuth)
{
    RigModel result = rig.clone();
    GlassWindow window = result.cameras[0]->window();
    const Vec3d across = normalize(window.normal.cross(Vec3d(0, 1, 0)));
    window.normal = normalize(window.normal + std::tan(degrees*CV_PI/180)
                              * (std::cos(azimuth)*across + std::sin(azimuth)*window.normal.cross(across)));
    result.cameras[0]->setWindow(window);
    return result;
}

bool mentions(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

struct Rates { double falseAlarms, found, predicted, named, paneFirst, inTwoSigma; };

//! Trials of one pair each, in a random place; calibration and noise level drawn anew.
Rates rates(const std::vector<Point3d>& object, double tiltDeg, double z, int trials, unsigned salt)
{
    scenes::Random random(salt);
    const RigModel truth = paperRig(1);
    const Mat covariance = calibratedCovariance(truth, board(6, 5), random);
    Rates result = {};
    int named = 0;
    for (int i = 0; i < trials; i++)
    {
        double chi = 0.;
        for (int k = 0; k < FREEDOM; k++)
            chi += std::pow(random.normal(1), 2);
        const double scale = chi/FREEDOM;
        const CheckInput input{drawn(truth, covariance, random), covariance*scale, SIGMA*std::sqrt(scale), FREEDOM};
        const Vec3d rvec = random.vector(0.3), tvec(random.uniform(-20, 20), random.uniform(-20, 20), z);
        const auto check = [&](const RigModel& now) {
            return checkRig(input, {observe(now, object, rvec, tvec, true, SIGMA, random)}, FALSE_ALARM);
        };
        const RigModel away = tilted(truth, tiltDeg, random.uniform(0, 2*CV_PI));
        result.falseAlarms += check(truth).changed/(double)trials;
        const CheckResult other = check(away);
        const WindowCheck& window = other.windows[0];
        result.found += other.changed/(double)trials;
        result.predicted += powerOf(window, other, tiltDeg)/trials;
        if (!window.moved)
            continue;
        named++;
        const std::string& first = other.changes[0].name;
        result.paneFirst += mentions(first, "thickness") || mentions(first, "index") || mentions(first, "wedge");
        const double off = std::acos(std::min(1., window.normal.dot(away.cameras[0]->window().normal)))*180/CV_PI;
        result.inTwoSigma += off < 2*window.stdDeg[0];
    }
    result.named = named/std::max(1e-9, result.found*trials);
    result.inTwoSigma /= std::max(1, named);
    return result;
}

} // namespace

TEST_CASE("A window that moved is found as often as predicted, and one that did not seldom", "[rig_check]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const int trials = 150;
    const Rates r = rates(board(9, 6, 30.), 0.2, 600, trials, 3010);
    CHECK(r.falseAlarms <= 0.05);                       // 1 %: more than 7 in 150 happens once in 1e4
    CHECK(r.found > 0.85);
    CHECK(r.found > r.predicted - 0.06);                // predicted is for the direction in which a tilt shows least
    CHECK(r.named > 0.95);                              // the tilt among what may have changed
    CHECK(r.paneFirst == 0);                            // which only another pane would have
    CHECK(r.inTwoSigma > 0.8);                          // 0.865 where both principal deviations are equal
}

TEST_CASE("Another pane in the same mount is not taken for one that moved", "[rig_check][slow]")
{
    scenes::Random random(3013);
    std::cout << "seed " << scenes::seed() << '\n';
    const int trials = 200;
    const double falseAlarm = 0.05, minute = CV_PI/180/60;
    const PaneStd std{0.05, 0.001, minute};
    int plain = 0, told = 0, found = 0;
    for (int i = 0; i < trials; i++)
    {
        RigModel truth = paperRig(1);
        GlassWindow pane = truth.cameras[0]->window();
        const GlassWindow kind = pane;
        const auto draw = [&] {
            pane.thickness[0] = kind.thickness[0] + random.normal(std.thickness);
            pane.index[0] = kind.index[0] + random.normal(std.index);
            pane.wedge = {Vec2d(random.normal(std.wedge), random.normal(std.wedge))};
            truth.cameras[0]->setWindow(pane);
        };
        draw();
        const RigModel calibrated = truth.clone();      // the calibration's own errors are far below a wedge's
        draw();
        const Vec3d rvec = random.vector(0.3), tvec(random.uniform(-20, 20), random.uniform(-20, 20), 600);
        const CheckInput input{calibrated, Mat(), SIGMA, FREEDOM};
        const auto check = [&](const CheckInput& before, const RigModel& now) {
            return checkRig(before, {observe(now, board(9, 6, 30.), rvec, tvec, true, SIGMA, random)}, falseAlarm).changed;
        };
        plain += check(input, truth);
        told += check(withNewPanes(input, std), truth);
        found += check(withNewPanes(input, std), tilted(truth, 6., random.uniform(0, 2*CV_PI)));
    }
    std::cout << "[numbers] pane exchanged, wedge 1' each, false alarms at 5 %: " << 100.*told/trials << " %; without --new-pane "
              << 100.*plain/trials << " %; a tilt of 6 degrees found in " << 100.*found/trials << " %\n";
    CHECK(plain > 0.8*trials);
    CHECK(told <= 24);                      // of 200 at 5 %: more happens once in 1e4
    CHECK(told >= 1);                       // 35 in a million have none
    CHECK(found > 0.9*trials);
}

TEST_CASE("A large tilt of a window is measured, and the camera named", "[rig_check]")
{
    scenes::Random random(3011);
    std::cout << "seed " << scenes::seed() << '\n';
    const std::vector<Point3d> object = board(6, 5);
    const RigModel rig = paperRig(2), now = tilted(rig, 5., 1.);
    const CheckInput input{rig, Mat(), 0.02, FREEDOM};
    for (bool direct : {true, false})       // two cameras that see the same board need no image without the window
    {
        const CheckResult result = checkRig(input, {observe(now, object, Vec3d(0.2, 0.3, 0), Vec3d(-20, 0, 620), direct, 0.02, random)},
                                            FALSE_ALARM);
        INFO(causesIn(result));
        CHECK(result.changed);
        REQUIRE(!result.changes.empty());
        REQUIRE(result.windows.size() == 2);
        CHECK(result.windows[0].moved);
        CHECK(result.windows[0].tiltDeg == Approx(5.).margin(5*result.windows[0].stdDeg[0]));
        if (direct)
            CHECK(mentions(result.changes[0].name, "window of camera 1 tilted"));
        CHECK_FALSE(result.windows[1].moved);
        CHECK(std::isnan(result.windows[1].tiltDeg));       // freed, it would be some number
        CHECK(result.explained);
        CHECK(result.sigmaSeen == Approx(0.02).epsilon(0.3));
    }
}

TEST_CASE("A board that moved within its pair is named", "[rig_check]")
{
    scenes::Random random(3012);
    std::cout << "seed " << scenes::seed() << '\n';
    const std::vector<Point3d> object = board(6, 5);
    const RigModel rig = paperRig(1);
    View view = observe(rig, object, Vec3d(0.2, 0.3, 0), Vec3d(-20, 0, 620), true, 0.02, random);
    view.glass[0] = observe(rig, object, Vec3d(0.2, 0.3, 0.02), Vec3d(-20, 0, 620), true, 0.02, random).glass[0];
    const CheckResult result = checkRig({rig, Mat(), 0.02, FREEDOM}, {view}, FALSE_ALARM);
    INFO(causesIn(result));
    CHECK(result.changed);
    REQUIRE(!result.changes.empty());
    CHECK(mentions(causesIn(result), "all boards"));
    CHECK_FALSE(mentions(causesIn(result), "tilted"));
    CHECK(std::isnan(result.windows[0].tiltDeg));

    View without = view;
    without.glass[0].clear();
    CHECK_THROWS_AS(checkRig({rig, Mat(), 0.02, FREEDOM}, {without}, FALSE_ALARM), Failure);
}

TEST_CASE("Blurred images are no change, and two changes are not called one", "[rig_check]")
{
    scenes::Random random(3014);
    std::cout << "seed " << scenes::seed() << '\n';
    const std::vector<Point3d> object = board(9, 6, 30.);
    const RigModel rig = paperRig(2);
    const CheckInput input{rig, Mat(), 0.02, FREEDOM};
    const auto views = [&](const RigModel& now, double sigma) {
        return std::vector<View>{observe(now, object, Vec3d(0.2, 0.3, 0), Vec3d(-20, 0, 620), true, sigma, random),
                                 observe(now, object, Vec3d(-0.3, 0.1, 0.1), Vec3d(20, 10, 700), true, sigma, random)};
    };
    const CheckResult blurred = checkRig(input, views(rig, 0.2), FALSE_ALARM);
    INFO(causesIn(blurred));
    CHECK_FALSE(blurred.changed);
    CHECK(blurred.sigma == Approx(0.2).epsilon(0.2));

    RigModel both = tilted(rig, 2., 1.);
    both.extrinsics[1].t *= 1.01;
    const CheckResult two = checkRig(input, views(both, 0.02), FALSE_ALARM);
    CHECK(two.changed);
    CHECK_FALSE(two.explained);
}

TEST_CASE("A focus that changed in all cameras alike is called so", "[rig_check]")
{
    scenes::Random random(3015);
    std::cout << "seed " << scenes::seed() << '\n';
    const std::vector<Point3d> object = board(9, 6, 30.);
    for (int cameras : {2, 3})
        for (double outerIndex : {1., 1.333})
        {
            RigModel rig = paperRig(cameras);
            for (const Ptr<RefractiveCamera>& camera : rig.cameras)
            {
                GlassWindow window = camera->window();
                window.outerIndex = outerIndex;
                camera->setWindow(window);
            }
            RigModel now = rig.clone();
            for (const Ptr<RefractiveCamera>& camera : now.cameras)
            {
                Mat lens = camera->lensParameters().clone();
                lens(Rect(0, 0, 1, 2)) *= 1.001;
                camera->setLensParameters(lens);
            }
            std::vector<View> views;
            for (double z : {520., 600., 680.})
                for (double turn : {-0.4, 0.4})
                    views.push_back(observe(now, object, Vec3d(0.3, turn, 0.1), Vec3d(-20, 0, z), outerIndex == 1., 0.02, random));
            const CheckResult result = checkRig({rig, Mat(), 0.02, FREEDOM}, views, FALSE_ALARM);
            INFO(cameras << " cameras, outer index " << outerIndex << ": " << causesIn(result));
            CHECK(result.changed);
            REQUIRE(!result.changes.empty());
            CHECK(mentions(result.changes[0].name, "focal lengths of all cameras"));
            CHECK(result.explained);
            REQUIRE(result.changes[0].values.size() == 1);
            CHECK(result.changes[0].values[0].value == Approx(0.1).margin(4.*result.changes[0].values[0].std));
        }
}

TEST_CASE("How often one pair at 0.1 px shows a tilt of 0.1 degrees", "[.monte-carlo]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const struct { const char* name; std::vector<Point3d> object; double z; } cases[] = {
        {"6x5 corners at 600 mm", board(6, 5), 600}, {"6x5 corners at 300 mm", board(6, 5, 20.), 300},
        {"11x8 corners at 600 mm", board(11, 8, 24.), 600}, {"14x10 corners at 600 mm", board(14, 10, 18.), 600},
        {"14x10 corners at 450 mm", board(14, 10, 14.), 450}};
    for (const auto& c : cases)
    {
        const Rates r = rates(c.object, 0.1, c.z, 1000, 3013);
        std::cout << format("[numbers] refract_check, one pair, %s: found %.1f %% (predicted %.1f %%), the window named in %.1f %% of "
                            "them, false alarms %.1f %%\n", c.name, 100*r.found, 100*r.predicted, 100*r.named, 100*r.falseAlarms);
        CHECK(r.falseAlarms < 0.02);
        CHECK(r.found > r.predicted - 0.04);
    }
}

TEST_CASE("A bent pane that two cameras share stays one pane, whatever of it has changed", "[check]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    scenes::Random random(7100);
    RigModel rig = paperRig(2);
    rig.windows = {0, 0};
    // Both its spheres have this centre, in camera 1; curvatures of either sign.
    const auto centreSeenBy = [](const RigModel& of, int c) {
        const GlassWindow window = of.cameras[c]->window();
        return of.extrinsics[c].inverse((window.distance - 1./window.curvature)*window.normal); };
    const auto checkOnePane = [&](const RigModel& of) {
        const double radius = 1./std::abs(of.cameras[0]->window().curvature);
        CHECK(norm(centreSeenBy(of, 0) - centreSeenBy(of, 1)) < 1e-9*radius); };
    for (double curvature : {3e-5, -4e-5})
    {
        GlassWindow window(Vec3d(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 1), 20., 1.52, 150., 1.333);
        window.shape = WINDOW_BENT;
        window.curvature = curvature;
        for (const Ptr<RefractiveCamera>& camera : rig.cameras)
            camera->setWindow(window);
        const RigModel shared = withVector(rig, toVector(rig));
        CAPTURE(curvature);
        checkOnePane(shared);
        int moves = 0;
        for (const Change& change : changesOf(shared, "mm", Vec3d(0, 0, 600)))
        {
            if (change.camera != 0 || change.name.find("indow") == std::string::npos)
                continue;
            RigModel changed = shared.clone();
            VectorXd delta = change.ranges();
            for (int i = 0; i < delta.size(); i++)
                delta[i] *= random.uniform(0.02, 0.1);
            change.apply(changed, delta);
            CAPTURE(change.name);
            checkOnePane(changed);
            moves++;
        }
        CHECK(moves >= 3);
    }
}
