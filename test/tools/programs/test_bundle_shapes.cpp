// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_bundle as a user runs it, on wands that are waved before cameras in domes, in tubes and behind bent panes.
#include "wand_scene.hpp"
#include <nlohmann/json.hpp>

using namespace cv;
using namespace cv::refract;
using namespace wand;

namespace {

const char* const GIVEN = " --thickness=5 --index=1.49 --outer-index=1.333";

GlassWindow domeAt(const Vec3d& center) { return GlassWindow::dome(center, 50, 5, 1.49, 1.333); }

GlassWindow tubeAt(const Vec3d& center, const Vec3d& axis) { return GlassWindow::tube(center, normalize(axis), 60, 5, 1.49, 1.333); }

GlassWindow paneAt(const Vec3d& normal, double curvature)
{
    GlassWindow window(normalize(normal), 5, 1.49, 40, 1.333);
    window.shape = WINDOW_BENT;
    window.curvature = curvature;
    return window;
}

//! What is not told by itself: the largest number of a unit vector, and of a tube's axis where along it its centre is.
bool follows(const Vec3d& unit, int i)
{
    const Vec3d a(std::abs(unit[0]), std::abs(unit[1]), std::abs(unit[2]));
    return i == (a[2] >= std::max(a[0], a[1]) ? 2 : a[1] >= a[0]);
}

//! Two rigs, number by number: of centres of tubes what is across their axis.
std::map<std::string, double> differences(const Rig& is, const Rig& truth)
{
    std::map<std::string, double> all;
    const std::map<std::string, double> found = is.parameters();
    for (const auto& parameter : truth.parameters())
        all[parameter.first] = found.at(parameter.first) - parameter.second;
    for (size_t c = 0; c < is.cameras.size(); c++)
    {
        const GlassWindow a = is.cameras[c]->window(), b = truth.cameras[c]->window();
        const std::string camera = std::to_string(c + 1) + " ";
        const Vec3d moved = a.center - b.center, across = moved - a.axis.dot(moved)*a.axis;
        for (int i = 0; i < 3; i++)
        {
            const std::string number = "[" + std::to_string(i) + "]";
            if (a.shape == WINDOW_TUBE)
                all[camera + "center" + number] = across[i];
            if (a.shape == WINDOW_TUBE && follows(a.axis, i))
            {
                all.erase(camera + "center" + number);
                all.erase(camera + "axis" + number);
            }
            if (a.shape == WINDOW_BENT && follows(a.normal, i))
                all.erase(camera + "normal" + number);
        }
    }
    return all;
}

//! e^T C^-1 e of the names that begin so, of either camera; `count` gets how many.
double squaredDistance(const Rig& found, const std::map<std::string, double>& off, const std::vector<std::string>& beginnings, int& count)
{
    const std::vector<std::string> columns = found.columnNames();
    const std::map<std::string, double> deviations = found.deviations();     // a curvature's is far smaller than others are
    std::vector<int> at;
    Mat e;
    for (int i = 0; i < (int)columns.size(); i++)
    {
        const auto begins = [&](const std::string& text) { return columns[i].compare(2, text.size(), text) == 0; };
        if (off.count(columns[i]) == 0 || std::none_of(beginnings.begin(), beginnings.end(), begins))
            continue;
        at.push_back(i);
        e.push_back(off.at(columns[i])/deviations.at(columns[i]));
    }
    Mat C(e.rows, e.rows, CV_64F), solved;
    for (int i = 0; i < e.rows; i++)
        for (int j = 0; j < e.rows; j++)
            C.at<double>(i, j) = found.covariance.at<double>(at[i], at[j])/deviations.at(columns[at[i]])/deviations.at(columns[at[j]]);
    count = e.rows;
    REQUIRE(count > 0);
    REQUIRE(solve(C, e, solved, DECOMP_CHOLESKY));
    return e.dot(solved);
}

/* Wands, each before windows as delivered: the mean of e^T C^-1 e, of what says where the windows are and of all, is as many as there are
numbers, within four standard deviations of that mean. */
void requireHonest(const std::string& what, const std::vector<GlassWindow>& thought, const std::vector<GlassWindow>& placed,
                   const std::string& options, const std::vector<std::string>& place, double bowStd = 0)
{
    const int trials = scenes::trials(16);
    double ofPlace = 0, ofAll = 0;
    int placeCount = 0, allCount = 0;
    for (int trial = 0; trial < trials; trial++)
    {
        std::vector<GlassWindow> windows = placed;
        scenes::Random bow(5100 + trial);
        for (GlassWindow& window : windows)
            window.curvature += bow.normal(1)*bowStd;
        const Wand wand(5000 + trial, thought, windows, 100);
        const TemporaryFolder f;
        wand.write(f, true);
        const ToolResult result = bundle(f, options + GIVEN);
        CAPTURE(what, scenes::seed(), trial, result.out, result.err);
        REQUIRE(result.code == 0);
        const Rig found = Rig::read(f / "calib.yml");
        const std::map<std::string, double> off = differences(found, wand.truth);
        ofPlace += squaredDistance(found, off, place, placeCount);
        std::vector<std::string> all = {"radius", "distance", "curvature", "thickness", "R", "T"};
        all.insert(all.end(), place.begin(), place.end());
        ofAll += squaredDistance(found, off, all, allCount);
    }
    WARN("[numbers] refract_bundle, " << what << ", " << trials << " wands, seed " << scenes::seed() << ": e^T C^-1 e of the places "
         << ofPlace/trials << " (expected " << placeCount << "), of all " << ofAll/trials << " (expected " << allCount << ")");
    CHECK(std::abs(ofPlace/trials - placeCount) < 4*std::sqrt(2.*placeCount/trials));
    CHECK(std::abs(ofAll/trials - allCount) < 4*std::sqrt(2.*allCount/trials));
}

} // namespace

TEST_CASE("refract_bundle finds two domes from a wand, from the cameras on, within their +-", "[tools][bundle][dome]")
{
    requireHonest("domes", {domeAt({}), domeAt({})}, {domeAt({5, -4, 9}), domeAt({-3, 2, 6})}, "--window=dome --radius=50", {"center"});
}

TEST_CASE("refract_bundle finds two tubes from a wand, within their +-", "[tools][bundle][dome]")
{
    requireHonest("tubes", {tubeAt({}, {0, 1, 0}), tubeAt({}, {0, 1, 0})},
                  {tubeAt({5, 0, 8}, {0.05, 1, 0.03}), tubeAt({-3, 0, 6}, {-0.04, 1, 0.06})}, "--window=tube --radius=60 --axis=0,1,0",
                  {"center", "axis"});
}

TEST_CASE("refract_bundle finds how two panes are bent, within what is said of it", "[tools][bundle][dome]")
{
    const double BOW = 8*2./1e6;        // 2 mm of sag per metre
    requireHonest("bent panes", {paneAt({0, 0, 1}, 0), paneAt({0, 0, 1}, 0)}, {paneAt({-0.08, 0.1, 1}, 0), paneAt({-0.03, 0.06, 1}, 0)},
                  "--distance=40 --bow-std=2", {"normal", "curvature"}, BOW);
}

TEST_CASE("refract_bundle speaks of a dome's centre, and knows it the next time", "[tools][bundle][dome]")
{
    Wand wand(61, {domeAt({}), domeAt({})}, {domeAt({5, -4, 9}), domeAt({-3, 2, 6})}, 100);
    const TemporaryFolder f;
    wand.write(f, true);
    const ToolResult result = bundle(f, std::string("--window=dome --radius=50 --summary=") + f / "summary.json" + GIVEN);
    CAPTURE(scenes::seed(), result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK(mentions(result.out, "camera 1: centre "));
    CHECK(mentions(result.out, "camera 2: centre "));
    CHECK(!mentions(result.out, "normal"));
    const nlohmann::json json = nlohmann::json::parse(readFile(f / "summary.json"));
    CHECK(json["cameras"][0]["center_from_start"]["by"].get<double>() == Approx(std::sqrt(122.)).margin(1.5));
    CHECK(json["cameras"][0]["center_from_start"]["std"].get<double>() > 0);
    CHECK(json["cameras"][0].count("normal_from_start_deg") == 0);
    CHECK(json["windows"].count("camera 2 centre z") == 1);
    const FileStorage file(f / "calib.yml", FileStorage::READ);
    CHECK(file["camera1"]["glass_window_std"]["center"].size() == 3);
    // A start with windows of its own, that knows them: other moments are within, and a dome that moved is not.
    std::filesystem::rename(f / "calib.yml", f / "start.yml");
    const Rig known = Rig::read(f / "start.yml");
    wand.wave(60);
    writeFile(f / "matches.csv", wand.matches());
    const ToolResult again = runTool(commandFor(f, ""));
    CAPTURE(again.out, again.err);
    CHECK(again.code == 0);
    const Rig better = Rig::read(f / "calib.yml");
    CHECK(better.deviations().at("1 center[0]") < known.deviations().at("1 center[0]"));
    GlassWindow moved = wand.truth.cameras[1]->window();
    moved.center += Vec3d(6, 0, 0);
    wand.truth.cameras[1]->setWindow(moved);
    wand.wave(100);
    writeFile(f / "matches.csv", wand.matches());
    const ToolResult held = runTool(commandFor(f, ""));
    CAPTURE(held.out, held.err);
    CHECK(held.code == 2);
    CHECK(mentions(held.err, "if free: center"));
    const ToolResult freed = runTool(commandFor(f, "--free=center"));
    CAPTURE(freed.out, freed.err);
    CHECK(freed.code == 0);
    const Rig found = Rig::read(f / "calib.yml");
    CHECK(std::abs(found.cameras[1]->window().center[0] - moved.center[0]) < 5*found.deviations().at("2 center[0]"));
    // What a drawing says of the centre is a prior.
    wand.write(f, true);
    const ToolResult drawn = bundle(f, std::string("--window=dome --radius=50 --center=5,-4,9 --center-std=0.01") + GIVEN);
    CAPTURE(drawn.out, drawn.err);
    CHECK(Rig::read(f / "calib.yml").deviations().at("1 center[0]") <= 0.0101);
}

TEST_CASE("Flat windows and domes in one rig of refract_bundle", "[tools][bundle][dome]")
{
    GlassWindow pane = paneAt({-0.08, 0.1, 1}, 0), straight = paneAt({0, 0, 1}, 0);
    pane.shape = straight.shape = WINDOW_FLAT;
    const Wand wand(62, {straight, domeAt({})}, {pane, domeAt({5, -4, 9})}, 100);
    const TemporaryFolder f;
    wand.write(f);
    const ToolResult result = bundle(f, "--wedge-std=1 --radius-std=0.1");
    CAPTURE(scenes::seed(), result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK(mentions(result.out, "camera 1: normal "));
    CHECK(mentions(result.out, "camera 2: centre "));
    const Rig found = Rig::read(f / "calib.yml");
    const std::map<std::string, double> std = found.deviations();
    for (const auto& off : differences(found, wand.truth))
        if (off.first.find("normal[2]") == std::string::npos)
        {
            CAPTURE(off.first, off.second, std.at(off.first));
            CHECK(std::abs(off.second) < 5*std.at(off.first));
        }
    CHECK(mentions(bundle(f, "--free=normal,extrinsics").err, "--free=normal,center, or none"));
}

TEST_CASE("What refract_bundle cannot take of a window's shape it refuses in one sentence", "[tools][bundle][dome]")
{
    const Wand wand(63, {domeAt({}), domeAt({})}, {domeAt({5, -4, 9}), domeAt({-3, 2, 6})}, 30);
    const std::string DOME = std::string("--window=dome --radius=50") + GIVEN, FLAT = std::string("--distance=40") + GIVEN;
    struct Bad { bool withoutWindows; std::string options, says; };
    for (const Bad& b : {Bad{true, "", "say what the cameras look through"},
                         Bad{true, std::string("--window=dome") + GIVEN, "--window=dome needs --radius"},
                         Bad{true, DOME + " --center=0,0,60", "outside its radius of 50"},
                         Bad{true, DOME + " --distance=4", "--distance is of a flat window"},
                         Bad{true, DOME + " --free=normal,extrinsics", "--free=center says"},
                         Bad{true, DOME + " --free=wedge", "--free=wedge is of a flat window"},
                         Bad{true, DOME + " --free=distance", "--free=distance is of a flat window"},
                         Bad{true, DOME + " --free=curvature", "say --free=radius"},
                         Bad{true, DOME + " --wedge-std=1", "--wedge-std is of a flat window"},
                         Bad{true, DOME + " --distance-std=1", "--distance-std is of a flat window"},
                         Bad{true, DOME + " --bow-std=1", "--bow-std is of a flat window"},
                         Bad{true, DOME + " --no-window", "--no-window says that there is none"},
                         Bad{true, std::string("--window=tube --radius=60") + GIVEN, "--window=tube needs --axis"},
                         Bad{true, std::string("--window=bent --distance=40") + GIVEN, "--bow-std=2"},
                         Bad{true, GIVEN, "--distance is needed"}, Bad{true, FLAT + " --radius=50", "add --window=dome"},
                         Bad{true, FLAT + " --free=radius", "--free=radius is of a dome or tube"},
                         Bad{true, FLAT + " --free=center,extrinsics", "--free=normal says"},
                         Bad{true, FLAT + " --radius-std=1", "--radius-std is of a dome or tube"},
                         Bad{true, FLAT + " --center-std=1", "--center-std is of a dome"},
                         Bad{false, DOME, "has a glass_window"}})
    {
        const TemporaryFolder f;
        wand.write(f, b.withoutWindows);
        if (b.withoutWindows && b.options.empty())
        {
            std::string start = readFile(f / "start.yml");
            for (size_t at = start.find("glass_window"); at != std::string::npos; at = start.find("glass_window"))
                start.erase(start.rfind('\n', at), start.find("outer_index", at) + 15 - start.rfind('\n', at));
            writeFile(f / "start.yml", start);
        }
        const ToolResult result = bundle(f, b.options);
        CAPTURE(b.options, result.out, result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, b.says));
        CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
        CHECK(!std::filesystem::exists(f / "calib.yml"));
    }
    const TemporaryFolder f;
    wand.write(f);
    std::string outside = readFile(f / "start.yml");
    const size_t at = outside.find("center:");
    outside.replace(at, outside.find('\n', at) - at, "center: [ 0., 0., 60. ]");
    writeFile(f / "start.yml", outside);
    const ToolResult result = bundle(f);
    CAPTURE(result.err);
    CHECK(result.code == 1);
    CHECK(mentions(result.err, "the camera must be inside the dome"));
}

// samples/data/wand: the same wand, before cameras in domes.
TEST_CASE("The wand of the guide before domes is made anew", "[.wand-data]")
{
    const std::string folder = paths::bundled() + "/wand";
    Wand wand(0, {domeAt({}), domeAt({})}, {domeAt({5, -4, 9}), domeAt({-3, 2, 6})}, 0);
    std::string start = readFile(folder + "/start.yml");
    for (size_t at = start.find("   glass_window"); at != std::string::npos; at = start.find("   glass_window"))
        start.erase(at, start.find('\n', at) + 1 - at);
    start = "%YAML:1.0\n---\n# Two cameras in domes under water, as a tape measure has them; of the domes the options of refract_bundle "
            "tell. Lengths in mm.\n" + start.substr(start.find("unit: mm"));
    writeFile(folder + "/dome_start.yml", start);
    const Rig thought = Rig::read(folder + "/dome_start.yml");
    wand.length = WAND + (wand.length - WAND)*0.1/WAND_STD;         // this one is known to 0.1 mm
    for (int c = 0; c < 2; c++)
    {
        const GlassWindow window = wand.truth.cameras[c]->window();
        wand.truth.cameras[c] = thought.cameras[c]->clone();
        wand.truth.cameras[c]->setWindow(window);
    }
    Matx33d turned;
    Rodrigues(Vec3d(0.01, -0.02, 0.015), turned);
    wand.truth.Rs = {thought.Rs[0], Mat(Mat(turned)*thought.Rs[1])};
    wand.truth.Ts = {thought.Ts[0], Mat(thought.Ts[1] + Mat(Vec3d(4, -6, 5)))};
    wand.wave(80);
    std::string csv = wand.matches();
    for (const auto& name : { std::make_pair(std::string(",a,"), std::string(",red,")), { ",b,", ",green," } })
        for (size_t at = csv.find(name.first); at != std::string::npos; at = csv.find(name.first, at))
            csv.replace(at, name.first.size(), name.second);
    writeFile(folder + "/dome_matches.csv", csv);
    writeRig(folder + "/dome_truth.yml", wand.truth.cameras, wand.truth.Rs, wand.truth.Ts);
}
