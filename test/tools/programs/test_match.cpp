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

TEST_CASE("Matches by other features of OpenCV, and a picture of them", "[programs][match]")
{
    const TemporaryFolder f;
    for (const char* features : { "ORB", "AKAZE" })
    {
        const ToolResult match = runTool("refract_match " + CALIB + " " + LEFT + " " + RIGHT + DEPTH + " --features=" + features
                                         + " --most-features=2000 --picture=" + f / "m.png" + " --out=" + f / "matches.csv");
        INFO(features << match.err + match.out);
        REQUIRE(match.code == 0);
        CHECK(mentions(match.out, "the same matches with the windows ignored"));
        const std::string csv = readFile(f / "matches.csv");
        CHECK(std::count(csv.begin(), csv.end(), '\n') > 150);
        const cv::Mat picture = cv::imread(f / "m.png"), left = cv::imread(LEFT);
        CHECK(picture.cols > 2*left.cols);
        CHECK(picture.rows == left.rows);
        std::filesystem::remove(f / "m.png");
    }
    const ToolResult wrong = runTool("refract_match " + CALIB + " " + LEFT + " " + RIGHT + DEPTH + " --features=SURFACES --out="
                                     + f / "none.csv");
    CHECK(wrong.code == 1);
    CHECK(mentions(wrong.err, "SIFT"));
    CHECK(!std::filesystem::exists(f / "none.csv"));
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
    // The calibration, from which a camera turns back.
    const double turned[] = { -0.03, -0.02, -0.035 };
    REQUIRE(first["about_axes"].size() == 3);
    for (int i = 0; i < 3; i++)
    {
        const nlohmann::json about = first["about_axes"][i];
        CHECK(about["axis"] == std::string(1, "xyz"[i]));
        CHECK(std::abs(about["value"].get<double>() - turned[i]) < 4*about["std"].get<double>());
        CHECK(about["std"].get<double>() < 0.01);
    }
    CHECK(first["about_axes"][0]["std"].get<double>() < 0.2*first["about_axes"][1]["std"].get<double>());
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
    const ToolResult result = check(CALIB, f / "l.png", f / "r.png", EXACT + " --summary=" + f / "s.json");
    INFO(result.err + result.out);
    CHECK(result.code == 1);
    CHECK(mentions(result.err, "matches"));
    CHECK(result.out.compare(0, 11, "cannot tell") == 0);
    CHECK(nlohmann::json::parse(readFile(f / "s.json"))["verdict"] == "cannot tell");
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

TEST_CASE("Images that are not sharp enough for any rig are said to be that", "[programs][match][check]")
{
    const TemporaryFolder f;
    cv::Mat right = cv::imread(RIGHT);
    cv::RNG random(11);
    cv::Mat u(right.size(), CV_32F), v(right.size(), CV_32F);
    random.fill(u, cv::RNG::NORMAL, 0, 300);
    random.fill(v, cv::RNG::NORMAL, 0, 300);
    cv::GaussianBlur(u, u, cv::Size(), 15);
    cv::GaussianBlur(v, v, cv::Size(), 15);
    for (int y = 0; y < right.rows; y++)
        for (int x = 0; x < right.cols; x++)
        {
            u.at<float>(y, x) += (float)x;
            v.at<float>(y, x) += (float)y;
        }
    cv::Mat wavy;
    cv::remap(right, wavy, u, v, cv::INTER_LINEAR);
    cv::imwrite(f / "wavy.png", wavy);
    const ToolResult result = check(CALIB, LEFT, f / "wavy.png");
    INFO(result.err + result.out);
    CHECK(result.code == 1);
    CHECK(mentions(result.err, "miss each other's rays by"));
    CHECK(!mentions(result.err, "0 of"));
}

TEST_CASE("Checks by a scene have a history: the second is another, and a turn that comes slowly is drawn", "[programs][match][history]")
{
    const TemporaryFolder f;
    writeTurned(f / "before.yml", cv::Vec3d(0.01, 0, 0));
    const cv::Mat left = cv::imread(LEFT), right = cv::imread(RIGHT);
    cv::RNG random(5);
    const auto write = [&](const std::string& path, const cv::Mat& image) {
        cv::Mat noise(image.size(), image.type()), noisy;
        random.fill(noise, cv::RNG::NORMAL, 10, 2);
        cv::add(image, noise, noisy);
        cv::subtract(noisy, cv::Scalar::all(10), noisy);
        cv::imwrite(path, noisy);
    };
    for (const std::string& calibration : { CALIB, f / "before.yml" })
    {
        const std::string history = " --history=" + f / (calibration == CALIB ? "same.json" : "turned.json");
        for (int month = 1; month <= 2; month++)
        {
            write(f / "l.png", left);
            write(f / "r.png", right);
            const ToolResult result = check(calibration, f / "l.png", f / "r.png",
                                            EXACT + history + cv::format(" --date=2025-%02d-01", month));
            INFO(result.err + result.out);
            CHECK(result.code == (calibration == CALIB ? 0 : 2));
            CHECK(mentions(result.out, cv::format("History of %d check", month)));
            if (calibration != CALIB)
                CHECK(mentions(result.out, "R of camera 2"));
            if (month == 2)
            {
                const ToolResult again = check(calibration, f / "l.png", f / "r.png", EXACT + history + " --date=2025-04-01");
                INFO(again.err + again.out);
                CHECK(again.code == 1);
            }
        }
        CHECK(std::filesystem::exists(f / (calibration == CALIB ? "same.html" : "turned.html")));
    }
}

TEST_CASE("A rig of which a camera turned is calibrated again by its scene", "[programs][match][bundle]")
{
    const TemporaryFolder f;
    // A covariance: all of R and T known to a hundredth of a degree and to 0.01 mm.
    std::vector<cv::Ptr<cv::refract::RefractiveCamera> > cameras;
    std::vector<cv::Mat> Rs, Ts;
    cv::refract::readRig(CALIB, cameras, Rs, Ts);
    const cv::Mat truth = Rs[1].clone();
    cv::Mat R;
    cv::Rodrigues(cv::Vec3d(0.2, -0.1, 0.15)*(CV_PI/180), R);
    Rs[1] = R*Rs[1];
    Ts[1] = R*Ts[1];
    const int places = (int)(cameras[0]->parameterNames().size() + cameras[1]->parameterNames().size());
    cv::Mat covariance = cv::Mat::zeros(places + 6, places + 6, CV_64F);
    for (int i = 0; i < 6; i++)
        covariance.at<double>(places + i, places + i) = std::pow(i < 3 ? 0.01*CV_PI/180 : 0.01, 2);
    cv::refract::writeRig(f / "before.yml", cameras, Rs, Ts, {}, covariance);
    ToolResult result = runTool("refract_match " + f / "before.yml" + " " + LEFT + " " + RIGHT + DEPTH + " --out=" + f / "matches.csv");
    INFO(result.err + result.out);
    REQUIRE(result.code == 0);
    result = runTool("refract_bundle " + f / "before.yml" + " --points=" + f / "matches.csv --turned=0.3 --out=" + f / "again.yml");
    INFO(result.err + result.out);
    CHECK(result.code == 0);
    cv::Mat found;
    std::vector<int> windows;
    cv::refract::readRig(f / "again.yml", cameras, Rs, Ts, windows, found);
    cv::Mat off;
    cv::Rodrigues(Rs[1]*truth.t(), off);
    CHECK(cv::norm(off) < 0.03*CV_PI/180);
    for (int i = 0; i < 3; i++)
        CHECK(std::abs(off.at<double>(i)) < 4*std::sqrt(found.at<double>(places + i, places + i)));
    // Where it is known which one turned, so is where the other camera looks from.
    cv::Mat named;
    result = runTool("refract_bundle " + f / "before.yml" + " --points=" + f / "matches.csv --turned=0,0.3 --out=" + f / "named.yml");
    CHECK(result.code == 0);
    cv::refract::readRig(f / "named.yml", cameras, Rs, Ts, windows, named);
    const cv::Rect ofT(places + 3, places + 3, 3, 3);
    CHECK(cv::trace(named(ofT))[0] < 0.9*cv::trace(found(ofT))[0]);
    result = runTool("refract_bundle " + f / "before.yml" + " --points=" + f / "matches.csv --turned=0,0.3,0 --out=" + f / "no.yml");
    CHECK(result.code == 1);
    CHECK(mentions(result.err, "--turned has 3 values"));
    result = runTool("refract_bundle " + CALIB + " --points=" + f / "matches.csv --turned=0.3 --out=" + f / "none.yml");
    CHECK(result.code == 1);
    CHECK(mentions(result.err, "--turned"));
}
