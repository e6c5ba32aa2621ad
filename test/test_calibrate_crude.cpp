// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Sealed rigs of which hardly anything is known: whatever the start, the minimum is the one that the truth leads to. The long
// form is hidden: run with [.crude], TRIALS rigs of each kind.
#include "crude_scenes.hpp"
#include "rig_scenes.hpp"
#include <sstream>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const double SIGMA = 0.3, SAME = 1e-3;      // px; standard deviations
const int STARTS = 2;

//! What became of the runs.
struct Tally
{
    int runs = 0, same = 0, better = 0, ambiguous = 0, refused = 0, wrong = 0;

    void add(const TankRig& tank, Random& random)
    {
        CrudeCall truth(tank, nullptr);
        const double least = truth.run();
        int points = 0;
        for (const std::vector<Point2d>& pixels : tank.pixels)
            for (const Point2d& p : pixels)
                points += !std::isnan(p.x);
        for (int start = 0; start < STARTS; start++)
        {
            CrudeCall call(tank, &random);
            runs++;
            try
            {
                const double rms = call.run(), difference = (rms*rms - least*least)*points/(SIGMA*SIGMA);
                if (std::abs(difference) < SAME*SAME)
                    same++;
                else if (difference < 0)
                    better++;
                else
                    (call.nearestRival() < 3 ? ambiguous : wrong)++;
            }
            catch (const cv::Exception& e)
            {
                refused++;
                UNSCOPED_INFO(e.err);
            }
        }
    }

    void print(const std::vector<int>& windows, int rigs) const
    {
        std::cout << "[numbers] crude starts, windows of the cameras";
        for (int w : windows)
            std::cout << " " << w;
        std::cout << ": " << rigs << " rigs, " << runs << " runs; the truth's minimum " << same << ", a better one " << better
                  << ", another that is reported as ambiguous " << ambiguous << ", refused " << refused
                  << ", another without a word " << wrong << " (seed " << seed() << ")" << std::endl;
    }
};

Tally tallyOf(const std::vector<int>& windows, int rigs)
{
    Tally tally;
    for (int i = 0; i < rigs; i++)
    {
        Random random(77000 + i);
        const TankRig tank(windows, random, SIGMA);
        tally.add(tank, random);
    }
    tally.print(windows, rigs);
    return tally;
}

} // namespace

TEST_CASE("Rigs of one to four cameras from crude starts", "[rig_glass][slow]")
{
    CAPTURE(seed());
    for (const std::vector<int>& windows : { std::vector<int>{ 0 }, { 0, 1 }, { 0, 0 }, { 0, 0, 1, 1 } })
    {
        const Tally tally = tallyOf(windows, 1);
        CHECK(tally.same == tally.runs);
    }
}

TEST_CASE("Rigs of one to eight cameras from crude starts", "[.crude]")
{
    const int rigs = trials(25);
    int runs = 0, right = 0;
    for (const std::vector<int>& windows : { std::vector<int>{ 0 }, { 0, 1 }, { 0, 0 }, { 0, 1, 2, 3 }, { 0, 0, 1, 1 },
                                             { 0, 0, 0, 0 }, { 0, 1, 2, 3, 4, 5, 6, 7 }, { 0, 0, 0, 0, 0, 0, 0, 0 } })
    {
        const Tally tally = tallyOf(windows, rigs);
        CHECK(tally.wrong == 0);
        runs += tally.runs;
        right += tally.same + tally.better;
    }
    CHECK(right >= 0.99*runs);
}

namespace {

//! Moves a part of the points of each image far away.
void misplace(std::vector<std::vector<Point2d> >& images, double part, Random& random)
{
    for (std::vector<Point2d>& pixels : images)
        for (Point2d& pixel : pixels)
            if (random.uniform(0, 1) < part)
                pixel += Point2d(random.uniform(20, 200), random.uniform(-200, -20));
}

/** A hand-held board: the direct images tell the lens, the others the window.
@param outliers part of the points that are misplaced */
void findSteepWindows(int rigs, double outliers)
{
    int runs = 0, right = 0;
    std::ostringstream wrong;
    for (int number = 1; number <= rigs; number++)
        for (double outerIndex : { 1., 1.333 })
        {
            Random random(8800 + number);
            const double tilt = random.uniform(0.7, 0.95), azimuth = random.uniform(0, 2*CV_PI);
            const Vec3d normal(std::sin(tilt)*std::cos(azimuth), std::sin(tilt)*std::sin(azimuth), std::cos(tilt));
            RigTruth rig;
            rig.windows = { 0 };
            rig.Rs = { Matx33d::eye() };
            rig.Ts = { Vec3d() };
            rig.cameras = { paperCamera(paper::pane(60, normal, outerIndex)) };
            const int images = 4;           // of each kind
            RigScene scene = makeRigScene(rig, 2*images, random, 0.1);
            for (int view = 0; view < 2*images; view++)
                (view < images ? scene.refracted : scene.direct)[0][view].clear();
            misplace(scene.direct[0], outliers, random);
            misplace(scene.refracted[0], outliers, random);
            RigCall call(rig, scene, true);
            Mat lens = call.cameras[0]->lensParameters().clone();
            lens.rowRange(0, 2) *= 1.02;
            call.cameras[0]->setLensParameters(lens);
            runs++;
            try
            {
                call.run(GLASS_FREE_INTRINSICS | (outerIndex > 1 ? GLASS_FREE_DISTANCE : 0) | (outliers > 0 ? GLASS_ROBUST : 0));
            }
            catch (const CalibrationError& e)
            {
                wrong << "number " << number << ": " << e.err << '\n';
                continue;
            }
            const int row = lens.rows;
            const Vec3d error = call.cameras[0]->window().normal - normal;
            const double off = std::sqrt(squaredMahalanobis({ error[0], error[1] }, call.covariance, { row, row + 1 }));
            right += off < 4.5;
            if (!(off < 4.5))
                wrong << "index " << outerIndex << ", number " << number << ", tilt " << tilt << ": off by " << off << '\n';
        }
    INFO(wrong.str());
    CHECK(right == runs);
}

} // namespace

TEST_CASE("A steep window is found from one that looks straight ahead, where the lens is estimated too", "[calibrate]")
{
    findSteepWindows(trials(3), 0);
}

TEST_CASE("A steep window is found among wrong points, where the lens is estimated too", "[calibrate]")
{
    findSteepWindows(trials(2), 0.1);
}

TEST_CASE("Steep windows are found from straight ones, where the lens is estimated too: forty rigs", "[.][calibrate]")
{
    SECTION("right points") { findSteepWindows(trials(20), 0); }
    SECTION("wrong points among them") { findSteepWindows(trials(20), 0.1); }
}
