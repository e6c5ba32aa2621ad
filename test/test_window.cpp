// GlassWindow: checks, reading and writing.
#include "scenes.hpp"

using namespace cv;
using namespace scenes;
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
    CHECK_THAT(thrown([] { GlassWindow(Vec3d(0, 0, 1), 1, 0.75); }), Contains("index") && Contains("0.75"));
}

TEST_CASE("What is written is read back to the last bit", "[window]")
{
    const char* extension = GENERATE(".yml", ".xml", ".json");
    CAPTURE(extension);
    for (const GlassWindow& window : { laminate(), GlassWindow(), GlassWindow(Vec3d(0, 0, 1), 1e-3, 4) })
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
                            Bad{ "{normal: [0, 0, 1], thickness: [1], index: [1.5], distance: far}", "distance" } })
    {
        CAPTURE(bad.text);
        FileStorage fs(std::string("%YAML:1.0\n---\nglass_window: ") + bad.text + "\n",
                       FileStorage::READ | FileStorage::MEMORY);
        window = laminate();
        CHECK_THAT(thrown([&] { fs["glass_window"] >> window; }), Contains(bad.named));
        checkEqual(window, laminate());
    }
}
