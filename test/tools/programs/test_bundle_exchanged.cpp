// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What refract_bundle says where what two cameras saw is given as each other's, or the fit ends far from the start.
#include "wand_scene.hpp"

using namespace cv;
using namespace cv::refract;
using namespace wand;

namespace {

const char* const DOMES = "--window=dome --radius=50 --thickness=5 --index=1.49 --outer-index=1.333";

//! Lenses of one kind, each a little different.
void giveLenses(Wand& wand)
{
    for (Rig* rig : {&wand.truth, &wand.start})
        for (size_t c = 0; c < rig->cameras.size(); c++)
        {
            const double f = 1600 + 9.*c;
            const Matx33d K(f, 0, 640 - 4.*c, 0, f, 512 + 3.*c, 0, 0, 1);
            const std::vector<double> D = { -0.1 - 0.01*c, 0.05, 0, 0 };
            rig->cameras[c] = RefractiveCamera::create(K, D, rig->cameras[c]->window());
            rig->cameras[c]->setImageSize(SIZE);
        }
    wand.wave(60);
}

Wand wandOf(unsigned salt, int cameras, bool domes)
{
    const std::vector<Vec3d> places = {{5, -4, 9}, {-3, 2, 6}, {4, 3, 7}, {-2, -5, 8}};
    std::vector<GlassWindow> thought, placed;
    for (int c = 0; c < cameras; c++)
    {
        thought.push_back(GlassWindow::dome({}, 50, 5, 1.49, 1.333));
        placed.push_back(GlassWindow::dome(places[c], 50, 5, 1.49, 1.333));
    }
    Wand wand = domes ? Wand(salt, thought, placed, 1) : Wand(salt, cameras, 1);
    giveLenses(wand);
    return wand;
}

ToolResult bundleOf(const Wand& wand, bool domes, const TemporaryFolder& f)
{
    wand.write(f, domes);
    return bundle(f, domes ? DOMES : "");
}

} // namespace

TEST_CASE("refract_bundle names the cameras whose observations are exchanged", "[tools][bundle][exchanged]")
{
    struct Case { int cameras; bool domes; int first; };
    for (const Case& one : {Case{3, false, 0}, {3, false, 1}, {4, false, 0}, {4, false, 1}, {3, true, 0}, {3, true, 1}, {4, true, 0},
                            {2, true, 0}})
    {
        Wand wand = wandOf(8100 + one.cameras, one.cameras, one.domes);
        std::swap(wand.pixels[one.first], wand.pixels[one.first + 1]);
        const TemporaryFolder f;
        const ToolResult result = bundleOf(wand, one.domes, f);
        CAPTURE(scenes::seed(), one.cameras, one.domes, one.first, result.out, result.err);
        CHECK(result.code == 2);
        CHECK(mentions(result.err, format("the observations of cameras %d and %d are exchanged", one.first + 1, one.first + 2)));
        CHECK_FALSE(mentions(result.err, "standard deviations"));
    }
}

TEST_CASE("refract_bundle accuses no cameras of an exchange that are in their order", "[tools][bundle][exchanged]")
{
    for (int cameras : {2, 3, 4})
        for (bool domes : {false, true})
        {
            const TemporaryFolder f;
            const ToolResult result = bundleOf(wandOf(8200 + cameras, cameras, domes), domes, f);
            CAPTURE(scenes::seed(), cameras, domes, result.out, result.err);
            CHECK(result.code == 0);
        }
    // What is wrong is something else.
    Wand wand = wandOf(8300, 3, false);
    for (const Ptr<RefractiveCamera>& camera : wand.start.cameras)
    {
        GlassWindow window = camera->window();
        window.outerIndex = 1.37;
        camera->setWindow(window);
    }
    const TemporaryFolder f;
    const ToolResult result = bundleOf(wand, false, f);
    CAPTURE(scenes::seed(), result.out, result.err);
    CHECK(result.code == 2);
    CHECK_FALSE(mentions(result.err, "exchanged"));
}

TEST_CASE("refract_bundle does not believe a rig that is far from its start", "[tools][bundle][exchanged]")
{
    Wand wand = wandOf(8400, 3, false);
    const Rig off = makeRig(3, {GlassWindow(), GlassWindow(), GlassWindow()}, 0.35, 0);
    wand.start.Rs[2] = off.Rs[2];
    wand.start.Ts[2] = off.Ts[2];
    const TemporaryFolder f;
    const ToolResult result = bundleOf(wand, false, f);
    CAPTURE(scenes::seed(), result.out, result.err);
    CHECK(result.code == 2);
    CHECK(mentions(result.out, "NOT USABLE"));
    CHECK(mentions(result.err, "R of camera 3 is 20"));
}

TEST_CASE("refract_bundle blames no lengths where the lenses are wrong", "[tools][bundle][exchanged]")
{
    struct Case { double factor; int cameras; bool domes; };
    for (const Case& one : {Case{0.5, 3, false}, {0.7, 3, false}, {1.5, 2, false}, {2., 2, false}, {0.7, 3, true}, {2., 2, true}})
    {
        Wand wand = wandOf(8500 + one.cameras, one.cameras, one.domes);
        for (Ptr<RefractiveCamera>& camera : wand.start.cameras)
        {
            Mat K = camera->cameraMatrix();
            K.at<double>(0, 0) *= one.factor;
            K.at<double>(1, 1) *= one.factor;
            camera = RefractiveCamera::create(K, camera->distCoeffs(), camera->window());
            camera->setImageSize(SIZE);
        }
        const TemporaryFolder f;
        const ToolResult result = bundleOf(wand, one.domes, f);
        CAPTURE(scenes::seed(), one.factor, one.domes, result.out, result.err);
        CHECK(result.code != 0);
        CHECK_FALSE(mentions(result.err, "the lengths of"));
        CHECK_FALSE(mentions(result.err, "exchanged"));
    }
}
