// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_check --history as a user runs it, month after month.
#include "calib_scene.hpp"
#include <nlohmann/json.hpp>
#include <filesystem>
#include <thread>

using namespace calib_scene;

namespace {

//! The images of one month; the window of camera 2 tilted by so many degrees.
void writeMonth(const TemporaryFolder& folder, unsigned salt, double tiltDeg)
{
    SceneOptions options;
    options.views = 3;
    options.stereo = true;
    options.window = [tiltDeg](int camera) {
        GlassWindow window = PaperRig().window(camera);
        if (camera == 1)
            window.normal = normalize(window.normal + std::tan(tiltDeg*CV_PI/180)*normalize(window.normal.cross(Vec3d(0, 1, 0))));
        return window;
    };
    writeScene(folder, options, salt);
}

std::string check(const std::string& calibration, const TemporaryFolder& month, const std::string& more)
{
    return "refract_check " + calibration + TARGET + " --direct=" + month / "direct1.vnl" + " --glass=" + month / "glass1.vnl"
        + images2(month) + more;
}

} // namespace

TEST_CASE("refract_check --history keeps checks, finds a drift and refuses what does not belong", "[tools][check][history]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const TemporaryFolder folder;
    SceneOptions options;
    options.stereo = true;
    writeScene(folder, options, 8000);
    const std::string calibration = folder / "calib.yml", history = " --history=" + folder / "rig.json";
    const ToolResult calib = runTool(brief(folder, images2(folder) + PANE + " --serial=W-0042 --no-cross-validation"));
    INFO(calib.out << calib.err);
    REQUIRE(calib.code == 0);

    const TemporaryFolder january, february, march;
    writeMonth(january, 8001, 0.);
    writeMonth(february, 8002, 0.);
    writeMonth(march, 8003, 0.3);
    for (const auto* month : {&january, &february})
    {
        const std::string time = month == &january ? " --date=2024-01-15" : " --date=2024-02-15T08:00:00+01:00";
        const ToolResult r = runTool(check(calibration, *month, history + time + " --serial=W-0042"));
        INFO(r.out << r.err);
        CHECK(r.code == 0);
        CHECK(r.err.empty());
        CHECK(mentions(r.out, "all charts are within their limits"));
    }
    const std::string kept = readFile(folder / "rig.json");

    // Refused, and nothing is written.
    const TemporaryFolder other;
    writeScene(other, options, 8009);
    const std::string another = other / "calib.yml", text = readFile(calibration);
    writeFile(another, text + "# edited\n");
    const std::string third = other / "third.yml";
    writeFile(third, std::string(text).replace(text.find("W-0042", text.find("\nwindow_serial")), 6, "W-0043"));
    writeFile(folder / "none.json", "{\"checks\": []}");
    // Last month's corners with a comment added, as another file.
    const TemporaryFolder again;
    for (const char* name : {"direct1.vnl", "glass1.vnl", "direct2.vnl", "glass2.vnl"})
        writeFile(again/name, readFile(february/name) + "# new\n");
    const struct { std::string command, says; } cases[] = {
        {check(calibration, january, history + " --date=2024-03-15"), "already"},
        {check(calibration, march, history + " --date=2024-01-01"), "backwards"},
        {check(calibration, march, history + " --date=2999-01-01"), "in the future"},
        {check(calibration, again, history + " --date=2024-03-15"), "stored anew"},
        {check(calibration, folder, history + " --date=2024-03-15"), "' of camera 1 calibrated"},
        {check(calibration, march, history + " --date=15.3.2026"), "--date=15.3.2026"},
        {check(calibration, march, history + " --serial=W-0043"), "W-0042"},
        {check(third, march, history), "another rig"},
        {check(another, march, history), "another calibration"},
        {check(calibration, march, " --history=" + folder / "none.json"), "no history"},
        {check(calibration, march, history + " --new-pane"), "--new-pane"},
        {check(calibration, march, history + "x.json --report=" + folder / "rig.jsonx.json"), "rig.jsonx.json"},
        {check(calibration, march, " --date=2024-03-15"), "--history"},
    };
    for (const auto& c : cases)
    {
        const ToolResult r = runTool(c.command);
        INFO(c.command << "\n" << r.out << r.err);
        CHECK(r.code == 1);
        CHECK(mentions(r.err, c.says));
        CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
        CHECK(readFile(folder / "rig.json") == kept);
    }

    // Two at once: none is lost.
    const TemporaryFolder april, may;
    writeMonth(april, 8004, 0.);
    writeMonth(may, 8005, 0.);
    std::filesystem::copy_file(folder / "rig.json", folder / "two.json");
    std::thread other1([&] { runTool(check(calibration, april, " --history=" + folder / "two.json --date=2024-05-15")); });
    runTool(check(calibration, may, " --history=" + folder / "two.json --date=2024-05-15"));
    other1.join();
    CHECK(nlohmann::json::parse(readFile(folder / "two.json"))["checks"].size() == 4);
    CHECK_FALSE(std::filesystem::exists(folder / "two.json.lock"));

    const ToolResult moved = runTool(check(calibration, march, history + " --date=2024-03-15 --summary=" + folder / "check.json"));
    INFO(moved.out << moved.err);
    CHECK(moved.code == 2);
    CHECK(mentions(moved.out, "window of camera 2: tilt has changed by"));
    CHECK(mentions(moved.out, "0.0027027, of the charts and this check together"));
    const nlohmann::json json = nlohmann::json::parse(readFile(folder / "check.json"));
    CHECK(json["history"]["checks"] == 3);
    CHECK(json["history"]["alarm"] == true);
    const nlohmann::json all = nlohmann::json::parse(readFile(folder / "rig.json"));
    REQUIRE(all["checks"].size() == 3);
    for (const nlohmann::json& value : all["checks"][2]["values"])
        if (value["name"] == "window of camera 2: tilt")
        {
            const Vec2d tilt(value["value"][0], value["value"][1]), std(value["std"][0], value["std"][1]);
            CHECK(norm(tilt) == Approx(0.3).margin(4.*norm(std)));
        }
    CHECK(all["checks"][1]["time"] == "2024-02-15T07:00:00Z");
    CHECK(all["window_serial"] == "W-0042");
    const std::string page = readFile(folder / "rig.html");
    CHECK(mentions(page, "</html>"));
    CHECK(mentions(page, "window of camera 2: tilt"));
    CHECK(mentions(page, "W-0042"));
    CHECK(!mentions(page, "http://www.w3.org/1999/xlink\" href=\"http"));       // nothing from elsewhere
}
