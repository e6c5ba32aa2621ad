// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_match, and refract_check by a scene, as a user runs them: on the bundled scene.
#include "run_tool.hpp"
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/refract.hpp>

namespace {

const std::string SCENE = paths::bundled() + "/scene", CALIB = SCENE + "/truth.yml";
const std::string LEFT = SCENE + "/glass1/scene.jpg", RIGHT = SCENE + "/glass2/scene.jpg", DEPTH = " --depth=430,1250";
const std::string EXACT = DEPTH + " --pixel-sigma=0.05";       // truth.yml has no covariance

//! The bundled rig with camera 2 turned about its own centre.
void writeTurned(const std::string& path, const cv::Vec3d& degrees)
{
    std::vector<cv::Ptr<cv::refract::RefractiveCamera> > cameras;
    std::vector<cv::Mat> Rs, Ts;
    cv::refract::readRig(CALIB, cameras, Rs, Ts);
    cv::Mat R;
    cv::Rodrigues(degrees*(CV_PI/180), R);
    Rs[1] = R*Rs[1];
    Ts[1] = R*Ts[1];
    cv::refract::writeRig(path, cameras, Rs, Ts);
}

ToolResult check(const std::string& calibration, const std::string& left, const std::string& right, const std::string& more = EXACT)
{
    return runTool("refract_check " + calibration + " --scene=" + left + " --scene2=" + right + more);
}

} // namespace

TEST_CASE("Matches of the bundled scene go into refract_bundle", "[programs][match]")
{
    const TemporaryFolder f;
    const ToolResult match = runTool("refract_match " + CALIB + " " + LEFT + " " + RIGHT + DEPTH + " --count=800 --out="
                                     + f / "matches.csv");
    INFO(match.err + match.out);
    REQUIRE(match.code == 0);
    CHECK(mentions(match.out, "left out"));
    const std::string csv = readFile(f / "matches.csv");
    CHECK(csv.rfind("image,id,u1,v1,u2,v2,std1,std2\nscene,", 0) == 0);
    CHECK(std::count(csv.begin(), csv.end(), '\n') > 600);
    CHECK(std::count(csv.begin(), csv.end(), '\n') <= 801);
    const ToolResult bundle = runTool("refract_bundle " + CALIB + " --points=" + f / "matches.csv --free=none --out=" + f / "again.yml");
    INFO(bundle.err + bundle.out);
    CHECK(bundle.code == 0);
    CHECK(mentions(bundle.out, "USABLE"));
}

TEST_CASE("refract_match says what is wrong with its input", "[programs][match]")
{
    const TemporaryFolder f;
    const std::string out = " --out=" + f / "m.csv";
    struct { std::string arguments, text; } const wrong[] = {
        { CALIB + " " + LEFT + DEPTH + out, "images of 1 are given" },
        { CALIB + " " + LEFT + " " + RIGHT + out, "--depth=NEAR,FAR" },
        { CALIB + " " + LEFT + " " + RIGHT + " --depth=50,60" + out, "in the window" },
        { CALIB + " " + LEFT + " " + LEFT + DEPTH + out, "given for both cameras" },
        { CALIB + " " + LEFT + " " + RIGHT + DEPTH + " --out=" + LEFT, "scene.jpg" } };
    for (const auto& w : wrong)
    {
        const ToolResult result = runTool("refract_match " + w.arguments);
        INFO(w.arguments + "\n" + result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, w.text));
        CHECK(!std::filesystem::exists(f / "m.csv"));
    }
}

TEST_CASE("A scene shows that a rig is unchanged, and what no scene shows is said", "[programs][match][check]")
{
    const TemporaryFolder f;
    const ToolResult result = check(CALIB, LEFT, RIGHT, EXACT + " --summary=" + f / "s.json");
    INFO(result.err + result.out);
    CHECK(result.code == 0);
    CHECK(result.out.compare(0, 9, "unchanged") == 0);
    CHECK(mentions(result.out, "No scene shows"));
    const nlohmann::json summary = nlohmann::json::parse(readFile(f / "s.json"));
    REQUIRE(summary["turns"].size() == 2);
    CHECK(summary["turns"][0]["detection_probability"] > 0.99);
}

TEST_CASE("A scene shows that a camera has turned by 0.05 degrees, and names it", "[programs][match][check]")
{
    const TemporaryFolder f;
    writeTurned(f / "before.yml", cv::Vec3d(0.03, 0.02, 0.035));
    const ToolResult result = check(f / "before.yml", LEFT, RIGHT, EXACT + " --summary=" + f / "s.json");
    INFO(result.err + result.out);
    CHECK(result.code == 2);
    const nlohmann::json first = nlohmann::json::parse(readFile(f / "s.json"))["changes"][0];
    CHECK(first["name"] == "R of camera 2 (turned about its own centre) changed by");
    CHECK(std::abs(first["value"][0].get<double>() - 0.0502) < 3*first["std"][0].get<double>());
    CHECK(first["std"][0].get<double>() < 0.01);
}

TEST_CASE("Where a third of an image has moved, that is no change of the rig", "[programs][match][check]")
{
    const TemporaryFolder f;
    cv::Mat right = cv::imread(RIGHT), part = right(cv::Rect(60, 60, 300, 340));
    part(cv::Rect(0, 4, 300, 336)).clone().copyTo(part(cv::Rect(0, 0, 300, 336)));
    cv::imwrite(f / "right.png", right);
    const ToolResult result = check(CALIB, LEFT, f / "right.png");
    INFO(result.err + result.out);
    CHECK(result.code == 0);
}

TEST_CASE("A wall without texture cannot tell", "[programs][match][check]")
{
    const TemporaryFolder f;
    cv::RNG random(7);
    for (const char* name : { "l.png", "r.png" })
    {
        cv::Mat wall(480, 640, CV_8U);
        random.fill(wall, cv::RNG::NORMAL, 120, 2);
        cv::imwrite(f / name, wall);
    }
    const ToolResult result = check(CALIB, f / "l.png", f / "r.png");
    INFO(result.err + result.out);
    CHECK(result.code == 1);
    CHECK(mentions(result.err, "matches"));
}

TEST_CASE("Images of cameras that are exchanged are named, and those of another rig", "[programs][match][check]")
{
    const TemporaryFolder f;
    ToolResult result = check(CALIB, RIGHT, LEFT);
    INFO(result.err + result.out);
    CHECK(result.code == 1);
    CHECK(mentions(result.err, "swapped"));
    writeTurned(f / "other.yml", cv::Vec3d(4, 2, 0));
    result = check(f / "other.yml", LEFT, RIGHT);
    INFO(result.err + result.out);
    CHECK(result.code == 1);
    CHECK(mentions(result.err, "is the calibration of this rig"));
}
