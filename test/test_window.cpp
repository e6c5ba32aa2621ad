// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// GlassWindow: checks, reading and writing.
#include "scenes.hpp"

using namespace cv;
using namespace scenes;
using cv::refract::refractiveIndex;
using Catch::Matchers::Contains;

static GlassWindow laminate()
{
    GlassWindow w(Vec3d(0.1, -0.2, 1), 6.1, 1.52, 30.3, 1.333);
    w.thickness = { 6.1, 0.76, 1.0/3 };
    w.index = { 1.52, 1.48, 1.5 };
    w.innerIndex = 1.0003;
    return w;
}

static void checkEqual(const GlassWindow& a, const GlassWindow& b)
{
    CHECK(norm(a.normal - b.normal) < 3e-16);
    CHECK(a.distance == b.distance);
    CHECK(a.thickness == b.thickness);
    CHECK(a.index == b.index);
    CHECK(a.innerIndex == b.innerIndex);
    CHECK(a.outerIndex == b.outerIndex);
    CHECK(a.wavelength == b.wavelength);
    CHECK(a.materials == b.materials);
}

//! A pane before water, indices as the catalogue has them at 540 nm.
static GlassWindow port()
{
    GlassWindow w(Vec3d(0.1, -0.2, 1), 10, 1.5, 40);
    w.materials = { "air", "N-BK7", "water:T=12" };
    return w.atWavelength(540);
}

TEST_CASE("A default window is no window", "[window]")
{
    const GlassWindow w;
    CHECK_NOTHROW(w.check());
    CHECK(w.normal == Vec3d(0, 0, 1));
    CHECK(w.thickness.empty());
    CHECK(w.index.empty());
    CHECK(w.innerIndex == 1);
    CHECK(w.outerIndex == 1);
}

TEST_CASE("The constructor of a pane normalises the normal", "[window]")
{
    const GlassWindow w(Vec3d(0, 3, 4), 20, 1.5, 7, 1.33);
    CHECK(norm(w.normal - Vec3d(0, 0.6, 0.8)) < 1e-15);
    CHECK(w.thickness == std::vector<double>{ 20 });
    CHECK(w.index == std::vector<double>{ 1.5 });
    CHECK(w.distance == 7);
    CHECK(w.innerIndex == 1);
    CHECK(w.outerIndex == 1.33);
    CHECK(GlassWindow(Vec3d(0, 0, 1e-100), 20, 1.5).normal == Vec3d(0, 0, 1));
}

TEST_CASE("A wrong field is named with its value", "[window]")
{
    struct Wrong { const char* field; const char* value; void (*spoil)(GlassWindow&); };
    const Wrong wrongs[] = {
        { "normal", "(0, 0, 0)", [](GlassWindow& w) { w.normal = Vec3d(0, 0, 0); } },
        { "normal", "(0, 0, 2)", [](GlassWindow& w) { w.normal = Vec3d(0, 0, 2); } },
        { "normal", "(0, 0, -1)", [](GlassWindow& w) { w.normal = Vec3d(0, 0, -1); } },
        { "normal", "(1, 0, 0)", [](GlassWindow& w) { w.normal = Vec3d(1, 0, 0); } },
        { "normal", "nan", [](GlassWindow& w) { w.normal[1] = NaN; } },
        { "distance", "-1.5", [](GlassWindow& w) { w.distance = -1.5; } },
        { "distance", "inf", [](GlassWindow& w) { w.distance = INF; } },
        { "distance", "nan", [](GlassWindow& w) { w.distance = NaN; } },
        { "thickness[1]", "-0.25", [](GlassWindow& w) { w.thickness[1] = -0.25; } },
        { "thickness[2]", "inf", [](GlassWindow& w) { w.thickness[2] = INF; } },
        { "thickness[0]", "nan", [](GlassWindow& w) { w.thickness[0] = NaN; } },
        { "index[0]", "0.9", [](GlassWindow& w) { w.index[0] = 0.9; } },
        { "index[2]", "nan", [](GlassWindow& w) { w.index[2] = NaN; } },
        { "index", "2", [](GlassWindow& w) { w.index.pop_back(); } },
        { "innerIndex", "0.5", [](GlassWindow& w) { w.innerIndex = 0.5; } },
        { "outerIndex", "0", [](GlassWindow& w) { w.outerIndex = 0; } },
        { "outerIndex", "inf", [](GlassWindow& w) { w.outerIndex = INF; } } };
    for (const Wrong& wrong : wrongs)
    {
        CAPTURE(wrong.field, wrong.value);
        GlassWindow w = laminate();
        REQUIRE_NOTHROW(w.check());
        wrong.spoil(w);
        CHECK_THAT(thrown([&] { w.check(); }), Contains(wrong.field) && Contains(wrong.value));
        // The same text wherever a window enters.
        CHECK_THAT(thrown([&] { RefractiveCamera::create(Matx33d::eye(), noArray(), w); }),
                   Contains(wrong.field) && Contains(wrong.value));
    }
    CHECK_THAT(thrown([] { GlassWindow(Vec3d(0, 0, 0), 1, 1.5); }), Contains("normal") && Contains("(0, 0, 0)"));
    CHECK_THAT(thrown([] { GlassWindow(Vec3d(0, INF, 1), 1, 1.5); }), Contains("normal") && Contains("inf"));
    CHECK_THAT(thrown([] { GlassWindow(Vec3d(0, 0, -1), 1, 1.5); }), Contains("normal") && Contains("-1"));
    CHECK_THAT(thrown([] { GlassWindow(Vec3d(0, 0, 1), -3, 1.5); }), Contains("thickness") && Contains("-3"));
    // A pane of thickness 0 has no effect.
    const Matx33d K(1000, 0, 640, 0, 1000, 480, 0, 0, 1);
    std::vector<Point2d> bare, through;
    refractiveProjectPoints(std::vector<Point3d>(1, Point3d(50, -20, 600)), Vec3d(), Vec3d(), K, noArray(), GlassWindow(), bare);
    refractiveProjectPoints(std::vector<Point3d>(1, Point3d(50, -20, 600)), Vec3d(), Vec3d(), K, noArray(),
                            GlassWindow(Vec3d(0.2, 0, 1), 0, 1.5, 30), through);
    CHECK(norm(bare[0] - through[0]) < 1e-10);
    CHECK_THAT(thrown([] { GlassWindow(Vec3d(0, 0, 1), 1, 0.75); }), Contains("index") && Contains("0.75"));
}

TEST_CASE("What is written is read back to the last bit", "[window]")
{
    const char* extension = GENERATE(".yml", ".xml", ".json");
    CAPTURE(extension);
    for (const GlassWindow& window : { laminate(), port(), GlassWindow(), GlassWindow(Vec3d(0, 0, 1), 1e-3, 4) })
    {
        FileStorage out(extension, FileStorage::WRITE | FileStorage::MEMORY);
        out << "before" << 1 << "glass_window" << window << "after" << 2;
        FileStorage in(out.releaseAndGetString(), FileStorage::READ | FileStorage::MEMORY);
        GlassWindow back;
        in["glass_window"] >> back;
        checkEqual(window, back);
        CHECK((int)in["before"] == 1);
        CHECK((int)in["after"] == 2);
    }
}

TEST_CASE("A missing window reads as the default, a bad one throws and changes nothing", "[window]")
{
    GlassWindow window = laminate();
    FileStorage empty("%YAML:1.0\n---\nother: 1\n", FileStorage::READ | FileStorage::MEMORY);
    read(empty["glass_window"], window, GlassWindow(Vec3d(0, 0, 1), 5, 1.5));
    checkEqual(window, GlassWindow(Vec3d(0, 0, 1), 5, 1.5));

    struct Bad { const char* text; const char* named; };
    for (const Bad& bad : { Bad{ "5", "glass_window" }, Bad{ "[1, 2]", "glass_window" },
                            Bad{ "{normal: [0, 1], thickness: [1], index: [1.5]}", "normal" },
                            Bad{ "{normal: [0, 0, a], thickness: [1], index: [1.5]}", "normal" },
                            Bad{ "{normal: [0, 0, -1], thickness: [1], index: [1.5]}", "normal" },
                            Bad{ "{normal: [0, 0, 1], thickness: [1], index: []}", "thickness" },
                            Bad{ "{normal: [0, 0, 1], thickness: [1], index: [0.5]}", "0.5" },
                            Bad{ "{normal: [0, 0, 1], thickness: [1], index: [1.5], distance: far}", "distance" },
                            Bad{ "{normal: [0, 0, 1], thickness: [1], index: [1.5], materials: [air, N-BK7]}", "materials" },
                            Bad{ "{normal: [0, 0, 1], thickness: [1], index: [1.5], materials: N-BK7}", "materials" },
                            Bad{ "{normal: [0, 0, 1], thickness: [1], index: [1.5], materials: [air, N-BK8, air]}", "N-BK7" },
                            Bad{ "{normal: [0, 0, 1], thickness: [1], materials: [air, K9, air], wavelength: 100}", "100" },
                            Bad{ "{normal: [0, 0, 1], thickness: [1], index: [1.5], outer_indx: 1.333}", "outer_indx" },
                            Bad{ "{normal: [0, 0, 1], thickness: [1], index: [1.5], wavelength: -1}", "wavelength" } })
    {
        CAPTURE(bad.text);
        FileStorage fs(std::string("%YAML:1.0\n---\nglass_window: ") + bad.text + "\n",
                       FileStorage::READ | FileStorage::MEMORY);
        window = laminate();
        CHECK_THAT(thrown([&] { fs["glass_window"] >> window; }), Contains(bad.named));
        checkEqual(window, laminate());
    }
}

TEST_CASE("A window of materials has the catalogue's indices at each wavelength", "[window]")
{
    const GlassWindow green = port();
    for (double wavelength : { 400., 465., 540., 610., 700. })
    {
        CAPTURE(wavelength);
        const GlassWindow w = green.atWavelength(wavelength);
        CHECK(w.wavelength == wavelength);
        CHECK(w.materials == green.materials);
        CHECK(w.index[0] == Approx(refractiveIndex("N-BK7", wavelength)).epsilon(1e-15));
        CHECK(w.outerIndex == Approx(refractiveIndex("water:T=12", wavelength)).epsilon(1e-15));
        CHECK(w.innerIndex == Approx(1).margin(1e-15));
        CHECK(w.distance == green.distance);
        CHECK(w.normal == green.normal);
        const GlassWindow back = w.atWavelength(540);
        CHECK(back.index[0] == Approx(green.index[0]).epsilon(1e-15));
    }
    CHECK(green.atWavelength(465).outerIndex - green.atWavelength(610).outerIndex == Approx(0.0062).margin(0.0003));
}

TEST_CASE("An estimated index keeps its distance from the catalogue's in another colour", "[window]")
{
    GlassWindow w = port();
    w.outerIndex *= 1.001;      // colder or saltier than was said
    CHECK(w.atWavelength(465).outerIndex == Approx(1.001*refractiveIndex("water:T=12", 465)).epsilon(1e-15));
    // A material that is not known has no colours.
    w.materials[1] = "";
    CHECK(w.atWavelength(465).index[0] == w.index[0]);
}

TEST_CASE("Indices that a file leaves out are those of its materials", "[window]")
{
    const struct { const char* wavelength; double nm; } cases[] = { { "", 550 }, { ", wavelength: 610", 610 } };
    for (const auto& c : cases)
    {
        FileStorage fs(format("%%YAML:1.0\n---\nw: {normal: [0, 0, 1], distance: 5, thickness: [10], "
                              "materials: [air, PMMA, water]%s}\n", c.wavelength), FileStorage::READ | FileStorage::MEMORY);
        GlassWindow window;
        fs["w"] >> window;
        CHECK(window.index == std::vector<double>{ refractiveIndex("PMMA", c.nm) });
        CHECK(window.outerIndex == refractiveIndex("water", c.nm));
        CHECK(window.wavelength == c.nm);
    }
}

TEST_CASE("Another colour is refused where nothing tells of it", "[window]")
{
    CHECK_THAT(thrown([] { laminate().atWavelength(465); }), Contains("window.materials is empty"));
    CHECK_NOTHROW(GlassWindow().atWavelength(465));         // what does not refract has no colours
    for (double wavelength : { 0., -1., NaN, INF, 100. })
        CHECK_THAT(thrown([=] { port().atWavelength(wavelength); }), Contains("wavelengthNm"));
    GlassWindow w = port();
    w.materials.pop_back();
    CHECK_THAT(thrown([&] { w.check(); }), Contains("window.materials has 2 names"));
    w = port();
    w.wavelength = NaN;
    CHECK_THAT(thrown([&] { w.check(); }), Contains("window.wavelength"));
}
