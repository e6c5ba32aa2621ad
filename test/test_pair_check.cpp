// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Pairs that are none: swapped arguments, images of different moments. And what must not be taken for it.
#include "round_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Contains;

namespace {

//! A camera and what it starts from.
struct Mono
{
    explicit Mono(const GlassWindow& window, int views = 6, double sigma = 0.1, int seedOf = 800)
        : random(seedOf), truth(paperCamera(window)), scene(makeScene(truth, views, random, sigma)) {}

    std::string why(const PixelViews& direct, const PixelViews& refracted, int flags = 0, double thicknessFactor = 1)
    {
        GlassWindow window = truth->window();
        window.normal = Vec3d(0, 0, 1);
        for (double& t : window.thickness)
            t *= thicknessFactor;
        const Ptr<RefractiveCamera> camera = paperCamera(window);
        const std::string text = thrown([&] { rms = calibrateGlass(scene.object, direct, refracted, camera, noArray(),
                                                                   noArray(), flags); });
        if (!text.empty())
            CHECK(camera->window().normal == Vec3d(0, 0, 1));       // a refusal leaves the start alone
        return text;
    }

    Random random;
    Ptr<RefractiveCamera> truth;
    CalibrationScene scene;
    double rms = -1;
};

const GlassWindow STRAIGHT = paper::pane(50, { 0, 0, 1 }), SLANTED = paper::pane(), HOUSING({ -0.1, 0.05, 1 }, 8, 1.49, 30, 1.333);

//! Each view's pixels at another view's place.
PixelViews rotated(PixelViews views)
{
    std::rotate(views.begin(), views.begin() + 1, views.end());
    return views;
}

} // namespace

TEST_CASE("Swapped direct and refracted points are named", "[pair_check]")
{
    for (const GlassWindow& window : { STRAIGHT, SLANTED, HOUSING })
        for (int flags : { 0, (int)GLASS_FREE_THICKNESS, (int)GLASS_ROBUST })
            for (int views : { 1, 6 })
            {
                Mono mono(window, views);
                CAPTURE(window.normal, window.outerIndex, flags, views);
                CHECK(mono.why(mono.scene.direct, mono.scene.refracted, flags) == "");
                const std::string text = mono.why(mono.scene.refracted, mono.scene.direct, flags);
                CAPTURE(mono.rms);
                CHECK_THAT(text, Contains("swapped") && Contains("imagePointsDirect"));
            }
}

TEST_CASE("Swapped points are named behind thin and slanted windows, too", "[pair_check]")
{
    for (double thickness : { 5., 10., 20. })
        for (double degrees : { 0., 6., 20., 36., 60. })
            for (int flags : { 0, (int)GLASS_ROBUST })
            {
                const double tilt = degrees*CV_PI/180;
                Mono mono(GlassWindow(Vec3d(0.8*std::sin(tilt), 0.6*std::sin(tilt), std::cos(tilt)), thickness, 1.5, 50), 6, 0.3);
                CAPTURE(thickness, degrees, flags, seed());
                CHECK(mono.why(mono.scene.direct, mono.scene.refracted, flags) == "");
                const std::string text = mono.why(mono.scene.refracted, mono.scene.direct, flags);
                CAPTURE(mono.rms);
                CHECK_THAT(text, Contains("swapped"));
            }
}

namespace {

//! A rig of any kind, and what came of its images, first as they are, then swapped.
struct AnyRig
{
    explicit AnyRig(int number) : random(8200 + number)
    {
        const bool isWater = number % 3 == 0;
        const int views = 1 + number % 8, flags = number % 5 == 2 ? GLASS_ROBUST : number % 5 == 3 ? GLASS_FREE_THICKNESS : 0;
        const double tilt = random.uniform(0, 0.7), azimuth = random.uniform(0, 2*CV_PI);
        const double thickness = std::pow(10., random.uniform(-1, 1.5)), sigma = std::pow(10., random.uniform(-2, 0));
        RigTruth truth = makeRig(number % 4 == 1 ? 2 : 1, { 0, 1 }, isWater ? 1.333 : 1);
        truth.windows.resize(truth.cameras.size());
        for (size_t c = 0; c < truth.cameras.size(); c++)
        {
            GlassWindow window = truth.cameras[c]->window();
            window.normal = Vec3d(std::sin(tilt)*std::cos(azimuth), std::sin(tilt)*std::sin(azimuth), std::cos(tilt));
            window.thickness[0] = thickness;
            truth.cameras[c]->setWindow(window);
        }
        const RigScene scene = makeRigScene(truth, views, random, sigma);
        what = format("%d: %d cameras, %d views, %s, %g thick, tilt %g, sigma %g, flags %d", number, (int)truth.cameras.size(), views,
                      isWater ? "water" : "air", thickness, tilt, sigma, flags);
        for (int swapped = 0; swapped < 2; swapped++)
        {
            RigCall call(truth, scene, true);       // whose windows look straight ahead
            if (swapped)
                std::swap(call.direct, call.refracted);
            text[swapped] = thrown([&] { rms[swapped] = call.run(flags); });
        }
        points = 2*views*(int)truth.cameras.size()*(int)board().size();
    }
    bool isRefused(int swapped) const
    { return Contains("swapped").match(text[swapped]) || Contains("same target").match(text[swapped]); }
    //! Logarithm of the likelihood that the right order has over the swapped one.
    double gain() const { return 2*points*std::log(rms[1]/rms[0]); }

    Random random;
    int points;
    std::string what, text[2];
    double rms[2];
};

} // namespace

TEST_CASE("No right pairs are refused, and swapped ones where the images tell", "[pair_check][slow]")
{
    const int TRIALS = trials(80);
    int named = 0, silent = 0;
    double most = 0;
    for (int i = 0; i < TRIALS; i++)
    {
        const AnyRig rig(i);
        CAPTURE(rig.what, rig.text[0], rig.text[1], seed());
        CHECK(!rig.isRefused(0));
        named += rig.isRefused(1);
        if (!rig.text[0].empty() || !rig.text[1].empty())
            continue;
        silent++;
        CAPTURE(rig.rms[0], rig.rms[1]);
        CHECK(rig.gain() < 24);         // of 12 that must be clear, and of most pairs
        most = std::max(most, rig.gain());
    }
    std::cout << "[numbers] swapped pairs: " << named << " of " << TRIALS << " named, " << silent << " fitted, of a likelihood of e^-"
              << most << " at least (seed " << seed() << ")" << std::endl;
    CHECK(named > TRIALS/2);
}

TEST_CASE("Swapped points of a pair of cameras, and of a rig, are named", "[pair_check]")
{
    Random random(810);
    const RigTruth truth = makeRig(2, { 0, 1 }, 1);
    const RigScene scene = makeRigScene(truth, 5, random, 0.1);
    RigCall call(truth, scene, true);
    std::swap(call.direct, call.refracted);
    CHECK_THAT(thrown([&] { call.run(GLASS_FREE_EXTRINSICS); }), Contains("swapped"));
    RigCall start(truth, scene, true);
    Mat R = start.Rs[1], T = start.Ts[1];
    CHECK_THAT(thrown([&] { stereoCalibrateGlass(scene.object, scene.refracted[0], scene.direct[0], scene.refracted[1],
                                                 scene.direct[1], start.cameras[0], start.cameras[1], R, T, noArray(),
                                                 noArray()); }), Contains("swapped"));
}

TEST_CASE("Images of different moments given as pairs are named", "[pair_check]")
{
    for (const GlassWindow& window : { STRAIGHT, SLANTED, HOUSING })
        for (int flags : { 0, (int)GLASS_FREE_THICKNESS, (int)GLASS_ROBUST })
        {
            Mono mono(window);
            CAPTURE(window.normal, window.outerIndex, flags);
            const std::string text = mono.why(mono.scene.direct, rotated(mono.scene.refracted), flags);
            CAPTURE(mono.rms);
            CHECK_THAT(text, !Contains("swapped"));
            // A robust fit may also find that no pair holds, and do without.
            if (!(flags & GLASS_ROBUST) || mono.rms < 0 || mono.rms > 0.2)
                CHECK_THAT(text, Contains("same target"));
        }
}

TEST_CASE("Wrong pairs are named behind layers of known materials, too", "[pair_check]")
{
    GlassWindow laminate(paper::NORMAL1, 10, 1.52, 50);
    laminate.thickness = { 10, 1.52, 10 };
    laminate.index = { 1.52, 1.48, 1.52 };
    laminate.materials = { "", "N-BK7", "PMMA", "N-BK7", "" };
    laminate.wavelength = 540;
    Mono mono(laminate);
    CHECK_THAT(mono.why(mono.scene.direct, rotated(mono.scene.refracted)), Contains("same target"));
}

TEST_CASE("A fit that is bad for other reasons is returned", "[pair_check]")
{
    SECTION("a wrong thickness")
    {
        for (const GlassWindow& window : { STRAIGHT, SLANTED, HOUSING })
            for (double factor : { 0.5, 0.9, 1.1, 2. })
            {
                Mono mono(window);
                CAPTURE(window.normal, window.outerIndex, factor);
                CHECK(mono.why(mono.scene.direct, mono.scene.refracted, 0, factor) == "");
                CHECK(mono.rms > 0.1);
            }
        GlassWindow laminate(paper::NORMAL1, 10, 1.52, 50);
        laminate.thickness = { 10, 1.52, 10 };
        laminate.index = { 1.52, 1.48, 1.52 };
        Mono mono(laminate);
        CHECK(mono.why(mono.scene.direct, mono.scene.refracted, 0, 2.) == "");
    }
    SECTION("corners of 2 px")
    {
        Mono mono(SLANTED, 6, 2.);
        CHECK(mono.why(mono.scene.direct, mono.scene.refracted) == "");
        CHECK(mono.rms > 2);
    }
    SECTION("a thin window, which moves the corners less than their noise")
    {
        for (double thickness : { 0.1, 0.5, 1. })
        {
            Mono mono(GlassWindow({ -0.1, 0.05, 1 }, thickness, 1.5, 50), 6, 0.3);
            CHECK(mono.why(mono.scene.direct, mono.scene.refracted) == "");
        }
    }
    SECTION("wrong corners among right ones")
    {
        Mono mono(SLANTED);
        displace(mono.scene.refracted, 0.3, mono.random);
        CHECK(mono.why(mono.scene.direct, mono.scene.refracted) == "");
        CHECK(mono.rms > 2);
    }
    SECTION("a robust fit leaves out boards that were moved")
    {
        Mono mono(SLANTED);
        std::swap(mono.scene.refracted[0], mono.scene.refracted[1]);
        CHECK(mono.why(mono.scene.direct, mono.scene.refracted, GLASS_ROBUST) == "");
        CHECK(mono.rms < 0.2);
    }
}

TEST_CASE("Pairs through domes and tubes: right ones are fitted, swapped ones are not", "[pair_check][dome][tube]")
{
    Random random(830);
    for (MakeWindow make : { domeAt, tubeAt })
        for (double outerIndex : { 1., 1.333 })
            for (double sigma : { 0.05, 0.2 })
            {
                const RigTruth truth = roundRig(make, 1, false, outerIndex, { 8, -6, 15 }, random);
                const RigScene scene = makeRigScene(truth, 6, random, sigma);
                CAPTURE(truth.cameras[0]->window().shape, outerIndex, sigma, seed());
                RigCall call = callFromCentre(truth, scene, true), swapped = call;
                swapped.cameras[0] = call.cameras[0]->clone();
                double right = 0, other = 0;
                CHECK(thrown([&] { right = call.run(0); }) == "");
                std::swap(swapped.direct, swapped.refracted);
                const std::string text = thrown([&] { other = swapped.run(0); });
                CAPTURE(text);
                std::cout << "[numbers] " << (make == tubeAt ? "tube" : "dome") << ", outer index " << outerIndex << ", sigma " << sigma
                          << ": " << right << " px, swapped " << (text.empty() ? std::to_string(other) : "refused") << std::endl;
                CHECK(!text.empty());
            }
}
