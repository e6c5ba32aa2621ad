// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Monte Carlo of calibrated domes and tubes: where they are is as good as the Cramer-Rao bound, and in every flow every +- holds.
#include "round_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

struct Shape
{
    const char* name;
    MakeWindow make;
};

const Shape SHAPES[] = { { "dome", domeAt }, { "tube", tubeAt } };

} // namespace

TEST_CASE("Where a dome or tube is, is as good as the Cramer-Rao bound", "[dome][tube][calibrate][slow]")
{
    CAPTURE(seed());
    const int TRIALS = trials(30);
    const double SIGMA = 0.1;
    struct Case { const char* name; bool paired; double outerIndex; int views; };
    for (const Shape& shape : SHAPES)
        for (const Case& c : { Case{ "4 pairs in air", true, 1, 4 }, Case{ "4 pairs in water", true, 1.333, 4 },
                               Case{ "20 hand-held views in water", false, 1.333, 20 } })
        {
            const Ptr<RefractiveCamera> camera = paperCamera(shape.make({ 4, -3, 6 }, c.outerIndex));
            const std::vector<int> place = placeRows(camera->window());
            const int freedom = freedomOfPlace(camera->window());
            double ofBound = 0, ofStated = 0;
            for (int trial = 0; trial < TRIALS; trial++)
            {
                Random random(6200 + trial);
                const CalibrationScene perfect = makeScene(camera, c.views, random, 0), scene = withNoise(perfect, random, SIGMA);
                Ptr<RefractiveCamera> found = paperCamera(shape.make(Vec3d(), c.outerIndex));
                Mat covariance;
                calibrateGlass(scene.object, c.paired ? scene.direct : PixelViews(), scene.refracted, found, noArray(), noArray(),
                               noArray(), covariance, noArray(), noArray(), 0);
                const Mat error(windowErrors(found->window(), camera->window()), true), part = error.rowRange(0, (int)place.size());
                ofBound += part.dot(placeInformation(perfect, c.paired, camera)*part)/(SIGMA*SIGMA*freedom*TRIALS);
                ofStated += overStated(error, covariance, place)/(freedom*TRIALS);
            }
            std::cout << "[numbers] " << shape.name << ", " << c.name << ": error of its place, of the Cramer-Rao bound "
                      << std::sqrt(ofBound) << ", of what is stated " << std::sqrt(ofStated) << std::endl;
            CAPTURE(shape.name, c.name);
            CHECK(std::abs(ofBound - 1) < 4*std::sqrt(2./(freedom*TRIALS)));
            CHECK(std::abs(ofStated - 1) < 4*std::sqrt(2./(freedom*TRIALS)));
        }
}

TEST_CASE("Domes and tubes with values drawn from their priors: in every flow errors are what is stated", "[dome][tube][given][slow]")
{
    CAPTURE(seed());
    const int TRIALS = trials(12);
    const Flow flows[] = {
        { "pairs in air", 1, false, true, 1, 6, 0 },
        { "pairs in water", 1, false, true, 1.333, 6, 0 },
        { "hand-held in water", 1, false, false, 1.333, 15, 0 },
        { "each in its own, pairs in water, R and T free", 2, false, true, 1.333, 6, GLASS_FREE_EXTRINSICS },
        { "each in its own, hand-held in water", 2, false, false, 1.333, 12, 0 },
        { "two cameras in one, pairs in water, R and T free", 2, true, true, 1.333, 6, GLASS_FREE_EXTRINSICS },
        { "pairs in water, lens free", 1, false, true, 1.333, 10, GLASS_FREE_INTRINSICS },
        { "pairs in water, robust", 1, false, true, 1.333, 8, GLASS_ROBUST },
    };
    for (const Shape& shape : SHAPES)
        for (const Flow& flow : flows)
        {
            double ofPlace = 0, ofWindow = 0, ofLast = 0;
            for (int trial = 0; trial < TRIALS; trial++)
            {
                const RoundTrial found = runRoundTrial(shape.make, flow, Given(), 6300 + trial);
                ofPlace += found.ofPlace/TRIALS;
                ofWindow += found.ofWindow/TRIALS;
                ofLast += found.ofLast/TRIALS;
            }
            std::cout << "[numbers] " << shape.name << "s, given values drawn from their priors, " << flow.name
                      << ": error over stated, place " << std::sqrt(ofPlace) << ", all of the window " << std::sqrt(ofWindow)
                      << ", place in the last camera's frame " << std::sqrt(ofLast) << std::endl;
            CAPTURE(shape.name, flow.name);
            const int freedom = freedomOfPlace(shape.make(Vec3d(), 1));
            CHECK(std::abs(ofPlace - 1) < 4*std::sqrt(2./(freedom*TRIALS)));
            CHECK(std::abs(ofWindow - 1) < 4*std::sqrt(2./((freedom + 3)*TRIALS)));
            CHECK(std::abs(ofLast - 1) < 4*std::sqrt(2./(freedom*TRIALS)));
        }
}
