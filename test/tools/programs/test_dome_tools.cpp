// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What is done with a calibration of cameras in domes: acceptance, the charts of its checks, laser lines.
#include "dome_scene.hpp"
#include <nlohmann/json.hpp>
#include <cmath>

using namespace dome_scene;

TEST_CASE("A rig in domes is accepted by lengths, and its checks are charted", "[tools][dome][accept_tool][history]")
{
    const Rendered rig(scene("[ 3., -2., 6. ]", "[ -4., 1., 5. ]", "50.06", "   bare: { window: 0, poses: [ test ] }\n"));
    const ToolResult calibrated = runTool(rig.calib() + DOME + "--no-cross-validation --quiet --out=" + rig.out("calib.yml"));
    INFO(calibrated.err);
    REQUIRE(calibrated.code == 0);
    writeFile(rig.out("lengths.csv"), "name,image1,id1,image2,id2,length,U\ntop,,0,,8,200.024,0.004\nside,,0,,45,125.015,0.004\n");
    const ToolResult accepted = runTool("refract_accept " + rig.out("calib.yml") + " " + rig.set("measure1") + " " + rig.set("measure2")
        + BOARD + " --lengths=" + rig.out("lengths.csv") + " --max-error=0.8 --verbose --certificate=" + rig.out("c.html") + " --dcc="
        + rig.out("c.xml"));
    INFO(accepted.out << accepted.err);
    CHECK(accepted.code == 0);
    CHECK(mentions(accepted.out, "PASS: all 6 lengths"));
    CHECK(mentions(accepted.out, "radius, camera 2"));
    CHECK(!mentions(accepted.out, "normal"));

    const std::string check = "refract_check " + rig.out("calib.yml") + BOARD + " --history=" + rig.out("h.json") + " --summary="
        + rig.out("s.json") + " --date=2024-01-01T00:00:00Z";
    const ToolResult checked = runTool(check + " --direct=" + rig.set("bare1") + " --direct2=" + rig.set("bare2") + " --glass="
                                       + rig.set("measure1") + " --glass2=" + rig.set("measure2"));
    INFO(checked.out << checked.err);
    CHECK(checked.code == 0);
    CHECK(mentions(checked.out, "all charts are within their limits"));
    CHECK(!mentions(checked.out, "tilt"));
    CHECK(mentions(readFile(rig.out("h.html")), "dome of camera 1: centre"));
}

TEST_CASE("A laser line is calibrated from a camera in a dome", "[tools][dome][laser_tool]")
{
    const TemporaryFolder f;
    std::string rig = readFile(paths::bundled() + "/laser/rig.yml");
    const auto putDome = [&rig](const std::string& from, const std::string& to, const std::string& window) {
        const size_t first = rig.find(from), end = rig.find(to, first);
        REQUIRE(end != std::string::npos);
        rig.replace(first, end - first, "glass_window: { shape: dome, " + window
                                        + ", thickness: [ 5. ], index: [ 1.49 ], outer_index: 1.333 }\n");
    };
    putDome("glass_window:\n   normal", "exposure", "center: [ 3., -2., 6. ], radius: 50.");
    putDome("glass_window:\n         normal", "      rvec", "center: [ 0., 0., 10. ], radius: 30.");
    writeFile(f / "rig.yml", rig);
    const ToolResult rendered = runTool("refract_simulate " + f / "rig.yml" + " --out-dir=" + f / "img" + " --quiet");
    INFO(rendered.err);
    REQUIRE(rendered.code == 0);
    const std::string laser = "refract_laser " + f / "img/truth.yml";
    const ToolResult sheet = runTool(laser + " '" + f / "img/board/*.png" + "' --size=8x7 --square=20 --sheet-out=" + f / "sheet.yml");
    INFO(sheet.out << sheet.err);
    REQUIRE(sheet.code == 0);
    CHECK(mentions(sheet.out, "Sheet of light: "));
    const ToolResult scan = runTool(laser + " '" + f / "img/scan/*.png" + "' --sheet=" + f / "sheet.yml" + " --out=" + f / "points.csv");
    INFO(scan.out << scan.err);
    REQUIRE(scan.code == 0);
    std::istringstream lines(readFile(f / "points.csv"));
    std::string line;
    std::getline(lines, line);
    REQUIRE(line == "image,id,u1,v1,x,y,z,sx,sy,sz,status");
    // The wall behind the steps is at z = 500, its edges aside.
    std::vector<double> off;
    while (std::getline(lines, line))
    {
        std::vector<std::string> cells;
        std::istringstream row(line);
        for (std::string cell; std::getline(row, cell, ',');)
            cells.push_back(cell);
        const double z = std::atof(cells[6].c_str());
        if (cells.back() == "0" && std::abs(z - 500) < 5)
            off.push_back(std::abs(z - 500));
    }
    REQUIRE(off.size() > 200);
    std::nth_element(off.begin(), off.begin() + off.size()/2, off.end());
    CHECK(off[off.size()/2] < 0.2);
    // A dome that was moved is another calibration.
    std::string moved = readFile(f / "img/truth.yml");
    moved.replace(moved.find("center: [ 3."), 12, "center: [ 4.");
    writeFile(f / "moved.yml", moved);
    const ToolResult other = runTool("refract_laser " + f / "moved.yml" + " '" + f / "img/scan/*.png" + "' --sheet=" + f / "sheet.yml"
                                     + " --out=" + f / "p.csv");
    CHECK(other.code == 1);
    CHECK(mentions(other.err, "another camera calibration"));
}
