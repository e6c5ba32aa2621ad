// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What can be known of windows without a target: the Cramer-Rao bound, and how near the bundle adjustment comes.
#include "bundle_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

struct Situation
{
    const char* name;
    double outerIndex;
    int cameras;                //!< several: a wand before a rig that stands still; one: it moves through points
    int free;
};

const int N = BundleBound::NORMAL, D = BundleBound::DISTANCE, T = BundleBound::THICKNESS, X = BundleBound::EXTRINSICS;
const double SIGMA = 0.1;       // px

RigTruth rigOf(const Situation& s)
{
    std::vector<int> windows;
    for (int c = 0; c < s.cameras; c++)
        windows.push_back(c);
    return makeRig(s.cameras, windows, s.outerIndex, 0.25);
}

//! 100 moments of a wand, or 12 views of 100 points; every camera sees them all.
BundleScene sceneOf(const Situation& s, const RigTruth& rig, Random& random, double sigma)
{
    return s.cameras > 1 ? makeWandScene(rig, 100, random, sigma) : makeMovingScene(rig, 12, 100, random, sigma);
}

std::string words(const Situation& s)
{
    return std::string(s.name) + ", free: normal" + (s.free & D ? ", distance" : "") + (s.free & T ? ", thickness" : "") +
           (s.free & X ? ", R, T" : "");
}

void printBound(const Situation& s)
{
    Random random(100);
    const RigTruth rig = rigOf(s);
    BundleScene scene = sceneOf(s, rig, random, 0);
    keepWhatAllSee(scene);
    const BundleBound bound(rig, scene, s.free, SIGMA);
    const int c = s.cameras - 1;        // the last one: camera 1 has the frame
    std::cout << "[numbers] " << words(s) << " (" << scene.points.size() << " points, " << scene.lengths.size()
              << " lengths): normal +- " << bound.normal(c)*180/CV_PI << " deg";
    if (s.free & D)
        std::cout << ", distance +- " << bound.distance(c) << " mm";
    if (s.free & T)
        std::cout << ", thickness +- " << bound.thickness(c) << " mm";
    std::cout << std::endl;
    CHECK(bound.normal(c) > 0);
}

//! Errors of the windows over the bound, and over what is stated.
struct Attained
{
    double normal = 0, distance = 0, boundOfNormal = 0, boundOfDistance = 0;    // mean squares
    Coverage ofNormal, ofDistance;
    double normalRatio() const { return std::sqrt(normal/boundOfNormal); }
    double distanceRatio() const { return std::sqrt(distance/boundOfDistance); }
};

//! Every trial a scene of its own and crude starts.
Attained attained(const Situation& s, int trials, int salt)
{
    const RigTruth rig = rigOf(s);
    Attained a;
    for (int trial = 0; trial < trials; trial++)
    {
        Random random(salt + trial);
        BundleScene scene = s.cameras > 1 ? makeWandScene(rig, 40, random, SIGMA) : makeMovingScene(rig, 6, 40, random, SIGMA);
        keepWhatAllSee(scene);
        const BundleBound bound(rig, scene, s.free, SIGMA);
        BundleCall call(rig, scene, random, 1, s.free & D ? 0.9 : 1);
        call.run((s.free & X ? GLASS_FREE_EXTRINSICS : 0) | (s.free & D ? GLASS_FREE_DISTANCE : 0) |
                 (s.free & T ? GLASS_FREE_THICKNESS : 0));
        for (int c = 0; c < s.cameras; c++)
        {
            const GlassWindow found = call.cameras[c]->window(), truth = rig.cameras[c]->window();
            const int first = 16*c + 8;         // 16 parameters each, 8 of the lens
            const Mat tangents(tangentsOf(truth.normal));
            const Mat error = tangents.t()*Mat(found.normal - truth.normal);
            const Mat stated = tangents.t()*call.covariance(Rect(first, first, 3, 3))*tangents;
            const Mat expected = bound.ofCamera(c);
            for (int i = 0; i < 2; i++)
            {
                const double e = error.at<double>(i);
                // In units of the bound, so that no camera's weak direction outweighs the others.
                a.normal += e*e/expected.at<double>(i, i);
                a.boundOfNormal += 1;
                a.ofNormal.add(e, std::sqrt(stated.at<double>(i, i)));
            }
            if (!(s.free & D))
                continue;
            const double e = found.distance - truth.distance;
            a.distance += e*e/expected.at<double>(2, 2);
            a.boundOfDistance += 1;
            a.ofDistance.add(e, call.stdDeviations.at<double>(first + 3));
        }
    }
    return a;
}

const double AIR = 1, WATER = 1.333;
const Situation WAND_IN_WATER = { "wand before 3 cameras, water", WATER, 3, N | D | X };
const Situation MOVING_IN_WATER = { "one camera moving, water", WATER, 1, N | D };

void report(const Situation& s, const Attained& a, int trials)
{
    std::cout << "[numbers] " << words(s) << ", " << trials << " trials: normal error/bound " << a.normalRatio()
              << ", error/stated " << a.ofNormal.rms();
    if (s.free & D)
        std::cout << "; distance error/bound " << a.distanceRatio() << ", error/stated " << a.ofDistance.rms();
    std::cout << std::endl;
}

} // namespace

TEST_CASE("What matches and a length tell of windows without a target: the table", "[.bundle-bound]")
{
    const Situation table[] = {
        { "wand before 2 cameras, air", AIR, 2, N }, { "wand before 2 cameras, air", AIR, 2, N | X },
        { "wand before 2 cameras, air", AIR, 2, N | T | X }, { "wand before 4 cameras, air", AIR, 4, N | X },
        { "wand before 4 cameras, air", AIR, 4, N | T | X },
        { "one camera moving, air", AIR, 1, N }, { "one camera moving, air", AIR, 1, N | T },
        { "wand before 2 cameras, water", WATER, 2, N }, { "wand before 2 cameras, water", WATER, 2, N | D },
        { "wand before 2 cameras, water", WATER, 2, N | X }, { "wand before 2 cameras, water", WATER, 2, N | D | X },
        { "wand before 2 cameras, water", WATER, 2, N | D | T | X },
        { "wand before 4 cameras, water", WATER, 4, N | X }, { "wand before 4 cameras, water", WATER, 4, N | D | X },
        { "wand before 4 cameras, water", WATER, 4, N | D | T | X },
        { "one camera moving, water", WATER, 1, N }, { "one camera moving, water", WATER, 1, N | D },
        { "one camera moving, water", WATER, 1, N | D | T } };
    for (const Situation& s : table)
        printBound(s);
}

TEST_CASE("Bundle adjustment attains the Cramer-Rao bound: many trials", "[.monte-carlo]")
{
    CAPTURE(seed());
    const int count = trials(200);
    for (const Situation& s : { WAND_IN_WATER, MOVING_IN_WATER })
    {
        const Attained a = attained(s, count, 20000);
        report(s, a, count);
        const double chance = 3/std::sqrt(2.*2*s.cameras*count);     // three times the scatter of such a ratio
        CHECK(a.normalRatio() < 1.05 + chance);
        CHECK(a.ofNormal.rms() == Approx(1).margin(0.05 + chance));
        CHECK(a.distanceRatio() < 1.05 + 1.5*chance);
        CHECK(a.ofDistance.rms() == Approx(1).margin(0.05 + 1.5*chance));
    }
}

TEST_CASE("Bundle adjustment attains the Cramer-Rao bound: a few trials", "[bundle][slow]")
{
    CAPTURE(seed());
    const int trials = 12;
    for (const Situation& s : { WAND_IN_WATER, MOVING_IN_WATER })
    {
        const Attained a = attained(s, trials, 30000);
        const double chance = 3/std::sqrt(2.*2*s.cameras*trials);
        CAPTURE(s.name);
        CHECK(a.normalRatio() < 1 + chance);
        CHECK(a.ofNormal.rms() == Approx(1).margin(chance));
        CHECK(a.distanceRatio() < 1 + 1.5*chance);
        CHECK(a.ofDistance.rms() == Approx(1).margin(1.5*chance));
    }
}
