// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What fitImages throws speaks of files and options.
#include "calibrate/fit.hpp"
#include "paper_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;
using Catch::Contains;
using Catch::StartsWith;

namespace {

//! Six pairs of the paper's rig; the first is not fitted, so that the library's numbers of views are not the data's.
struct Pairs
{
    explicit Pairs(int cameras) : rig(paperRig(cameras))
    {
        scenes::Random random(740);
        data.cameraCount = cameras;
        for (int i = 0; i < 6; i++)
        {
            const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660));
            data.views.push_back(observe(rig, board(6, 5), random.vector(0.4), tvec, true, 0.1, random));
            data.views.back().stem = "pair" + std::to_string(i);
        }
    }

    CalibrationError error(int iterations = MAX_ITERATIONS) const
    {
        try
        {
            fitImages(data, rig, {1, 2, 3, 4, 5}, 0, iterations);
        }
        catch (const CalibrationError& e)
        {
            return e;
        }
        FAIL("no error");
        throw;
    }

    RigModel rig;
    RigData data;
};

} // namespace

TEST_CASE("A view that cannot be used is told by its name", "[fit_error]")
{
    Pairs few(1);
    few.data.views[3].direct[0].clear();
    for (size_t i = 3; i < few.data.views[3].glass[0].size(); i++)
        few.data.views[3].glass[0][i].x = NAN;
    const CalibrationError pose = few.error();
    CHECK(pose.cause == CalibrationError::NO_POSE);
    CHECK_THAT(pose.err, StartsWith("view 'pair3': no pose of the target was found; fewer than 4 of its points"));
    CHECK_THAT(pose.what(), Contains(pose.err));

    Pairs far(1);
    GlassWindow window = far.rig.cameras[0]->window();
    window.distance = 900;
    far.rig.cameras[0]->setWindow(window);
    const CalibrationError image = far.error();
    CHECK(image.cause == CalibrationError::NO_IMAGE);
    CHECK_THAT(image.err, StartsWith("view 'pair1' of camera 1, point (-97.5, -78, 0): no image through the window")
                          && Contains("--distance"));
}

TEST_CASE("Errors of pairs and windows are told with options, not with arguments", "[fit_error]")
{
    Pairs swapped(1);
    for (View& view : swapped.data.views)
        std::swap(view.direct[0], view.glass[0]);
    const CalibrationError exchanged = swapped.error();
    CHECK(exchanged.cause == CalibrationError::PAIRS_SWAPPED);
    CHECK_THAT(exchanged.err, StartsWith("the --direct images and the --glass images are swapped: exchanged they fit to 0."));

    Pairs moved(1);
    for (int i = 0; i < 5; i++)
        std::swap(moved.data.views[i].glass[0], moved.data.views[i + 1].glass[0]);
    const CalibrationError contradicting = moved.error();
    CHECK(contradicting.cause == CalibrationError::PAIRS_CONTRADICT);
    CHECK_THAT(contradicting.err, Contains("must show the same target") && Contains("--unpaired") && !Contains("imagePoints"));

    Pairs hidden(2);
    for (View& view : hidden.data.views)
        view.glass[1].clear();
    const CalibrationError unseen = hidden.error();
    CHECK(unseen.cause == CalibrationError::WINDOW_NOT_SEEN);
    CHECK_THAT(unseen.err, StartsWith("the --glass2 images have no point"));

    Pairs slow(1);
    slow.rig.cameras[0]->setWindow(paper::pane(50, Vec3d(0, 0, 1)));
    const CalibrationError endless = slow.error(1);
    CHECK(endless.cause == CalibrationError::NOT_CONVERGED);
    CHECK(endless.err == "the calibration did not converge in 1 iterations");
}
