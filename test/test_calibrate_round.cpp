// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What calibrations of domes and tubes do alike: from crude starts to the truth. What each has of its own is in a file of its own.
#include "round_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

TEST_CASE("Where a dome or tube is from crude starts, in air and water, thick and thin, far off the camera", "[dome][tube][calibrate]")
{
    Random random(6100);
    CAPTURE(seed());
    for (MakeWindow make : { domeAt, tubeAt })
        for (double outerIndex : { 1., 1.333 })
            for (bool paired : { true, false })
                for (double thickness : { 3., 30. })
                    for (const Vec3d& center : { Vec3d(2, -1, 3), Vec3d(0, 0, -15), Vec3d(14, -12, 20), Vec3d(-20, 15, -10) })
                    {
                        RigTruth truth = roundRig(make, 1, false, outerIndex, center, random);
                        GlassWindow window = truth.cameras[0]->window();
                        CAPTURE(window.shape, outerIndex, paired, thickness, center);
                        window.thickness[0] = thickness;
                        if (window.shape == WINDOW_TUBE)
                            window.axis = normalize(Vec3d(0.15, 1, -0.1));
                        truth.cameras[0]->setWindow(window);
                        RigCall call = callFromCentre(truth, makeRigScene(truth, 8, random, 0), paired);
                        CHECK(call.run(0) < 1e-6);
                        const Vec2d errors = placeErrors(call, truth);
                        CHECK(errors[0] < (paired ? 1e-5 : 1e-3));
                        CHECK(errors[1] < (paired ? 1e-6 : 1e-4));
                    }
}

TEST_CASE("The radius of a dome or tube and the index outside are estimated where images tell them", "[dome][tube][calibrate]")
{
    Random random(6101);
    CAPTURE(seed());
    for (MakeWindow make : { domeAt, tubeAt })
    {
        const RigTruth truth = roundRig(make, 1, false, 1.333, { 8, -6, 15 }, random);
        const RigScene scene = makeRigScene(truth, ObjectViews(10, board()), random, 0, 300, 900);
        const WindowLayout at = windowLayout(truth.cameras[0]->window());
        struct Case { int flag, row; };
        for (const Case& c : { Case{ GLASS_FREE_RADIUS, at.distance }, Case{ GLASS_FREE_OUTER_INDEX, at.outerIndex } })
        {
            RigCall call = callFromCentre(truth, scene, true);
            GlassWindow window = call.cameras[0]->window();
            window.radius += c.flag == GLASS_FREE_RADIUS ? 5 : 0;
            window.outerIndex += c.flag == GLASS_FREE_OUTER_INDEX ? 0.02 : 0;
            call.cameras[0]->setWindow(window);
            CAPTURE(window.shape, c.flag);
            CHECK(call.run(c.flag) < 1e-6);
            CHECK(placeErrors(call, truth)[0] < 1e-4);
            CHECK(std::abs(call.cameras[0]->window().radius - 70) < 1e-4);
            CHECK(std::abs(call.cameras[0]->window().outerIndex - 1.333) < 1e-7);
            CHECK(call.stdDeviations.at<double>(LENS_PARAMETERS + c.row) > 0);
        }
    }
}
