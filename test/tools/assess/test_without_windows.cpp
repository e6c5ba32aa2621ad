// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Images that are given as through a window, though it was out: of boards and of scenes, and never said of right ones.
#include "assess/check_problem.hpp"
#include "assess/measured_causes.hpp"
#include "assess/rig_check.hpp"
#include "match/drawn_matches.hpp"
#include "match/match_scene.hpp"
#include "paper_rig.hpp"
#include <catch2/catch.hpp>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

const double SIGMA = 0.03, DEGREE = CV_PI/180.;
const char SAID[] = "taken without the window";

GlassWindow pane(double degrees, double azimuth, double outerIndex)
{
    const double s = std::sin(degrees*DEGREE);
    return GlassWindow(Vec3d(s*std::cos(azimuth), s*std::sin(azimuth), std::cos(degrees*DEGREE)), 20, 1.52, 60, outerIndex);
}

RigModel rigBehind(const GlassWindow& first, const GlassWindow& second)
{
    RigModel rig = paperRig(2);
    rig.cameras[0]->setWindow(first);
    rig.cameras[1]->setWindow(second);
    return rig;
}

struct Behind
{
    std::string name;
    RigModel rig;
};

std::vector<Behind> rigsBehind()
{
    std::vector<Behind> all;
    for (const double outer : {1., 1.333})
        for (const double degrees : {0., 10., 25., 40.})
            all.push_back({cv::format("panes tilted by %g degrees, outer index %g", degrees, outer),
                           rigBehind(pane(degrees, 0.4, outer), pane(degrees, 3., outer))});
    all.push_back({"domes in water", rigBehind(GlassWindow::dome(Vec3d(4, -3, 12), 80, 6, 1.49, 1.333),
                                               GlassWindow::dome(Vec3d(-5, 2, 8), 80, 6, 1.49, 1.333))});
    return all;
}

//! Of a calibration that is exact. @param seenBy the rig that took the images
CheckResult checkOf(const RigModel& calibrated, const RigModel& seenBy, int views, unsigned salt)
{
    scenes::Random random(salt);
    std::vector<View> all;
    for (int i = 0; i < views; i++)
        all.push_back(observe(seenBy, board(8, 6, 30.), random.vector(0.4),
                              Vec3d(random.uniform(-40, 40), random.uniform(-30, 30), random.uniform(620, 800)), false, SIGMA, random));
    return checkRig({calibrated, Mat(), SIGMA, 1e8}, all, 1e-4, "mm");
}

RigModel without(const RigModel& rig, const std::vector<int>& cameras)
{
    RigModel out = rig.clone();
    for (int c : cameras)
        out.cameras[c] = copyWithWindow(rig.cameras[c], GlassWindow());
    return out;
}

bool says(const CheckResult& result)
{
    return std::any_of(result.changes.begin(), result.changes.end(), [](const NamedChange& c) {
        return c.name.find(SAID) != std::string::npos; });
}

} // namespace

TEST_CASE("Images of boards taken without windows are called so, behind any of them, and right ones never", "[rig_check][without_windows]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    for (const Behind& behind : rigsBehind())
        for (const int views : {1, 4})
        {
            CAPTURE(behind.name, views);
            CHECK_FALSE(says(checkOf(behind.rig, behind.rig, views, 6100 + views)));
            for (const std::vector<int>& cameras : {std::vector<int>{0, 1}, {0}, {1}})
            {
                const CheckResult result = checkOf(behind.rig, without(behind.rig, cameras), views, 6110 + views);
                INFO(causesIn(result));
                REQUIRE(result.changed);
                CHECK(result.explained);
                REQUIRE(!result.changes.empty());
                CHECK(result.changes[0].name == takenWithoutWindow(cameras, 2));
                CHECK(result.isMixup);
            }
        }
}

TEST_CASE("A window that turned far, or is another, is not called one that was out", "[rig_check][without_windows]")
{
    for (const double degrees : {3., 12., 30.})
        for (const double outer : {1., 1.333})
        {
            const RigModel rig = rigBehind(pane(20., 0.4, outer), pane(20., 3., outer));
            RigModel turned = rig.clone(), thinner = rig.clone();
            turned.cameras[0]->setWindow(pane(20. + degrees, 1.1, outer));
            GlassWindow window = pane(20., 0.4, outer);
            window.thickness[0] /= degrees;
            thinner.cameras[0]->setWindow(window);
            for (const RigModel& now : {turned, thinner})
            {
                const CheckResult result = checkOf(rig, now, 4, 6200);
                INFO(degrees << ' ' << outer << ' ' << causesIn(result));
                CHECK(result.changed);
                CHECK_FALSE((says(result) && result.explained));
            }
        }
}

TEST_CASE("A scene seen without windows is called so, whatever wrong matches are left, and a right one never",
          "[tools][match][without_windows]")
{
    using namespace match_scene;
    for (const double outer : {1., 1.333})
        for (const std::vector<int>& cameras : {std::vector<int>{}, {0, 1}, {0}, {1}})
        {
            Rig rig(6300, outer);
            rig.truth = without(rig.truth, cameras);
            const FeatureNoise noise{ { 0.05 }, 0, 0, { { 1, 1 } } };
            ScaledMatches matches = drawSeen(rig, { 2, 600 }, noise);
            const size_t some = cameras.empty() ? matches.size() : 100;
            for (size_t i = 0; i < (size_t)matches.size(); i += some)
                matches.matches.pixels[1][i].y += 2.;
            const std::string mixup = mixupIn(rig.calibration, observationsOf(modelOf(rig.calibration), matches.matches), 0.05);
            CAPTURE(outer, cameras.size());
            CHECK(mixup == (cameras.empty() ? "" : takenWithoutWindow(cameras, 2)));
        }
}
