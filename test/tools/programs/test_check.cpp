// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_check as a user runs it: on the bundled images, whose truth is known.
#include "run_tool.hpp"
#include "paths.hpp"
#include "scenes.hpp"
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/refract.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <fcntl.h>
#include <unistd.h>

namespace {

const std::string STEREO = paths::bundled() + "/stereo";
const std::string TARGET = " --size=6x5 --square=39 --pixel-sigma=0.015";
const std::string LARGE = " --detect=1";        // so that no small tilt shows

std::string pair(const std::string& name, bool second = true)
{
    return " --direct=" + STEREO + "/direct1/" + name + " --glass=" + STEREO + "/glass1/" + name
        + (second ? " --direct2=" + STEREO + "/direct2/" + name + " --glass2=" + STEREO + "/glass2/" + name : "");
}

//! The truth as a calibration file, the window of camera 2 turned.
void writeCalibration(const std::string& path, double degrees)
{
    const cv::FileStorage in(STEREO + "/truth.yml", cv::FileStorage::READ);
    cv::FileStorage out(path, cv::FileStorage::WRITE);
    for (const std::string name : {"camera1", "camera2"})
    {
        const auto camera = cv::refract::RefractiveCamera::read(STEREO + "/truth.yml", name);
        cv::refract::GlassWindow window = camera->window();
        if (name == "camera2")
            window.normal = cv::normalize(window.normal + std::tan(degrees*CV_PI/180)
                                          * cv::normalize(window.normal.cross(cv::Vec3d(0, 1, 0))));
        camera->setWindow(window);
        out << name << "{";
        camera->write(out);
        out << "}";
    }
    cv::Mat R, T;
    in["R"] >> R;
    in["T"] >> T;
    out << "R" << R << "T" << T;
}

//! The truth with R of camera 2 turned by so much about its own centre, and camera 1's focal length longer by a factor.
void writeChanged(const std::string& path, double degrees, double focus)
{
    writeCalibration(path, 0.);
    std::vector<cv::Ptr<cv::refract::RefractiveCamera>> cameras;
    std::vector<cv::Mat> Rs, Ts;
    cv::refract::readRig(path, cameras, Rs, Ts);
    cv::Mat R, lens = cameras[0]->lensParameters().clone();
    cv::Rodrigues(cv::Vec3d(0, degrees*CV_PI/180, 0), R);
    lens.at<double>(0) *= focus;
    lens.at<double>(1) *= focus;
    cameras[0]->setLensParameters(lens);
    cv::FileStorage out(path, cv::FileStorage::WRITE);
    for (int c = 0; c < 2; c++)
    {
        out << (c ? "camera2" : "camera1") << "{";
        cameras[c]->write(out);
        out << "}";
    }
    out << "R" << R*Rs[1] << "T" << R*Ts[1];
}

//! Why this machine cannot give a program a terminal, as where /dev/pts is not mounted; empty: it can.
std::string whyNoTerminal()
{
    const int master = posix_openpt(O_RDWR | O_NOCTTY);
    const char* name = master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0 ? ptsname(master) : nullptr;
    const int slave = name ? open(name, O_RDWR | O_NOCTTY) : -1;
    const std::string why = slave >= 0 ? "" : std::strerror(errno);
    for (int descriptor : {slave, master})
        if (descriptor >= 0)
            close(descriptor);
    return why;
}

} // namespace

TEST_CASE("refract_check finds the window that moved, and no other", "[tools][check]")
{
    const TemporaryFolder folder;
    writeCalibration(folder / "same.yml", 0.);
    writeCalibration(folder / "moved.yml", 1.);
    const ToolResult same = runTool("refract_check " + folder / "same.yml" + TARGET + LARGE + pair("pair3.jpg"));
    INFO(same.out << same.err);
    CHECK(same.code == 0);
    CHECK(same.out.compare(0, 9, "unchanged") == 0);
    CHECK(same.err.empty());

    const ToolResult moved = runTool("refract_check " + folder / "moved.yml" + TARGET + LARGE + pair("pair3.jpg") + " --summary="
                                     + folder / "check.json");
    INFO(moved.out << moved.err);
    CHECK(moved.code == 2);
    CHECK(moved.out.compare(0, 5, "moved") == 0);
    const nlohmann::json json = nlohmann::json::parse(readFile(folder / "check.json"));
    CHECK(json["verdict"] == "moved");
    REQUIRE(json["windows"].size() == 2);
    CHECK(json["windows"][0]["moved"] == false);
    CHECK(json["windows"][0]["tilt_deg"].is_null());        // not the cause
    REQUIRE(!json["changes"].empty());
    CHECK(json["changes"][0]["name"] == "window of camera 2 tilted by");
    CHECK(json["changes"][0]["camera"] == 2);
    CHECK(json["changes"][0]["unit"][0] == "degrees");
    CHECK(json["changes"][0]["value"][0].get<double>() == Approx(1.).margin(5*json["changes"][0]["std"][0].get<double>() + 0.02));
    CHECK(json["changes"][0]["p"].get<double>() < 1e-6);
    CHECK(mentions(moved.out, "window of camera 2 tilted by"));
    CHECK(json["windows"][1]["moved"] == true);
    CHECK(json["windows"][1]["tilt_deg"].get<double>() == Approx(1.).margin(5*json["windows"][1]["tilt_std_deg"][0].get<double>()));

    // One image each is a pair whatever its name: the example of --help.
    std::filesystem::copy_file(STEREO + "/direct1/pair3.jpg", folder / "direct.jpg");
    std::filesystem::copy_file(STEREO + "/glass1/pair3.jpg", folder / "glass.jpg");
    const ToolResult named = runTool("refract_check " + folder / "same.yml" + TARGET + " --direct=" + folder / "direct.jpg"
                                     + " --glass=" + folder / "glass.jpg" + LARGE);
    INFO(named.out << named.err);
    CHECK(named.code == 0);

    // A direct image without partner among several is named.
    const ToolResult alone = runTool("refract_check " + folder / "same.yml" + TARGET + " --direct='" + STEREO
        + "/direct1/pair[1-4].jpg' --glass='" + STEREO + "/glass1/pair[1-3].jpg'" + LARGE);
    INFO(alone.out << alone.err);
    CHECK(alone.code == 0);
    CHECK(alone.err.find("'pair4'") != std::string::npos);

    // One camera.
    CHECK(runTool("refract_check " + folder / "same.yml" + TARGET + LARGE + pair("pair[1-3].jpg", false)).code == 0);
    // A motion of the boards that is said to be none is no tilt either.
    const ToolResult silent = runTool("refract_check " + folder / "same.yml" + TARGET + " --placement-std=0" + pair("pair3.jpg"));
    INFO(silent.out << silent.err);
    CHECK(silent.code == 2);
    CHECK(silent.out.compare(0, 7, "changed") == 0);
    CHECK(mentions(silent.out, "--placement-std"));
    CHECK(!mentions(silent.out, "tilted"));

    // Images through the windows alone show a large tilt, but no 0.1 degrees.
    const std::string glassOnly = TARGET + " --glass='" + STEREO + "/glass1/*' --glass2='" + STEREO + "/glass2/*'";
    const ToolResult unsure = runTool("refract_check " + folder / "same.yml" + TARGET + " --glass='" + STEREO + "/glass1/*'");
    CHECK(unsure.code == 1);
    CHECK(unsure.err.find("a pair without and with the window") != std::string::npos);
    writeCalibration(folder / "far.yml", 1.);
    const ToolResult far = runTool("refract_check " + folder / "far.yml" + glassOnly);
    INFO(far.out << far.err);
    CHECK(far.code == 2);
}

TEST_CASE("refract_check names what changed, whatever it is", "[tools][check]")
{
    const TemporaryFolder folder;
    writeCalibration(folder / "same.yml", 0.);
    writeChanged(folder / "turned.yml", 0.05, 1.);
    writeChanged(folder / "focus.yml", 0., 1.002);
    const std::string pairs = pair("pair3.jpg"), images = TARGET + pairs;
    const auto exchanged = [&](const std::string& option) {
        return " --" + option + "=" + STEREO + "/" + option + "2/pair3.jpg --" + option + "2=" + STEREO + "/" + option + "1/pair3.jpg"; };
    const struct { std::string command, says; } cases[] = {
        {folder / "turned.yml" + images, "R of camera 2"},
        {folder / "focus.yml" + images, "focal length of camera 1 changed by -0.19"},
        {folder / "same.yml" + " --size=6x5 --square=39.39 --pixel-sigma=0.015" + pairs, "square of the board"},
        {folder / "same.yml" + TARGET + exchanged("direct") + exchanged("glass"), "images of cameras 1 and 2 exchanged"},
        {folder / "same.yml" + TARGET + " --direct=" + STEREO + "/direct1/pair1.jpg --glass=" + STEREO + "/glass1/pair2.jpg",
         "not in one place"},
    };
    for (const auto& c : cases)
    {
        const ToolResult r = runTool("refract_check " + c.command);
        INFO(c.command << "\n" << r.out << r.err);
        CHECK(r.code == 2);
        CHECK(mentions(r.out, c.says));
    }
}

TEST_CASE("A verdict has a colour on a terminal alone", "[tools][check]")
{
    const std::string missing = whyNoTerminal();
    if (!missing.empty())
    {
        WARN("SKIPPED: no pseudo-terminal: " << missing);
        return;
    }
    const TemporaryFolder folder;
    writeCalibration(folder / "same.yml", 0.);
    writeCalibration(folder / "moved.yml", 1.);
    const std::string arguments = TARGET + LARGE + pair("pair3.jpg") + " --summary=" + folder / "check.json";
    const std::string green = "\033[1;32munchanged\033[0m", red = "\033[1;31mmoved\033[0m";
    // script gives a program a terminal, and writes what it says.
    const auto onTerminal = [&](const std::string& environment, const std::string& file) {
        const std::string command = environment + " " + paths::programs() + "/refract_check " + folder/file + arguments;
        REQUIRE(std::system(("script -qec \"" + command + "\" /dev/null </dev/null >" + folder / "typescript").c_str()) != -1);
        return readFile(folder / "typescript");
    };
    CHECK(mentions(onTerminal("env -u NO_COLOR TERM=xterm", "same.yml"), green));
    CHECK(mentions(onTerminal("env -u NO_COLOR TERM=xterm", "moved.yml"), red));
    CHECK(!mentions(readFile(folder / "check.json"), "\033"));
    CHECK(mentions(onTerminal("env -u NO_COLOR TERM=xterm NO_COLOR=", "same.yml"), green));
    // NO_COLOR is of colours: a line of progress, after a second, is still drawn and erased. A dumb terminal takes no escapes at all.
    const struct { std::string environment, unwanted; } plain[] = {{"env TERM=xterm NO_COLOR=1", "\033[1;"},
                                                                   {"env -u NO_COLOR TERM=dumb", "\033"}};
    for (const auto& terminal : plain)
    {
        const std::string text = onTerminal(terminal.environment, "same.yml");
        CHECK(mentions(text, "unchanged"));
        CHECK(!mentions(text, terminal.unwanted));
    }
    CHECK(!mentions(runTool("refract_check " + folder / "same.yml" + arguments, "env -u NO_COLOR TERM=xterm").out, "\033"));
}

TEST_CASE("Point files bring their target along", "[tools][check]")
{
    const TemporaryFolder folder;
    std::cout << "seed " << scenes::seed() << '\n';
    scenes::Random random(4400);
    std::vector<cv::Point3d> target;
    for (int i = 0; i < 30; i++)
        target.push_back(cv::Point3d(39.*(i % 6), 39.*(i/6), 0));
    const auto writePoints = [&](const std::string& calibration) {
        const auto camera = cv::refract::RefractiveCamera::read(calibration, "camera1");
        std::ofstream csv(folder / "points.csv");
        csv << std::setprecision(10) << "view,x,y,z,u,v\n";
        for (int view = 0; view < 8; view++)
        {
            std::vector<cv::Point2d> pixels;
            cv::refract::refractiveProjectPoints(target, random.vector(0.3), cv::Vec3d(-97, -78, 750) + random.vector(20), camera,
                                                pixels);
            for (size_t i = 0; i < target.size(); i++)
                csv << view << "," << target[i].x << "," << target[i].y << ",0," << pixels[i].x + random.normal(0.05) << ","
                    << pixels[i].y + random.normal(0.05) << "\n";
        }
    };
    writeCalibration(folder / "same.yml", 0.);
    writeChanged(folder / "other.yml", 0., 1.02);
    const std::string check = "refract_check " + folder / "same.yml" + " --pixel-sigma=0.05 --detect=3 --glass=";
    writePoints(folder / "same.yml");
    const ToolResult same = runTool(check + folder / "points.csv");
    INFO(same.out << same.err);
    CHECK(same.code == 0);
    writePoints(folder / "other.yml");
    const ToolResult other = runTool(check + folder / "points.csv");
    INFO(other.out << other.err);
    CHECK(other.code == 2);
    const ToolResult images = runTool(check + STEREO + "/glass1/pair1.jpg");
    CHECK(images.code == 1);
    CHECK(mentions(images.err, "give --size and --square"));
}

TEST_CASE("refract_check says when it cannot tell, and why", "[tools][check]")
{
    const TemporaryFolder folder;
    writeCalibration(folder / "same.yml", 0.);
    const std::string check = "refract_check " + folder / "same.yml";
    const struct { std::string command, says; } cases[] = {
        {check + TARGET + pair("pair3.jpg", false) + " --detect=0.001", "--detect"},
        {check + TARGET + " --direct='" + STEREO + "/direct1/air0[12].jpg' --glass='" + STEREO + "/glass1/pair[12].jpg'",
         "--glass='" + STEREO + "/glass1/pair[12].jpg' in which the target was found: the two images of a pair need equal names"},
        {check + " --size=6x5 --square=39" + pair("pair3.jpg"), "--pixel-sigma"},
        {check + TARGET + " --glass=" + folder / "none.png", "none.png"},
        {"refract_check " + folder / "none.yml" + TARGET + pair("pair3.jpg"), "none.yml"},
        {check + TARGET, "--glass"},
        {check + TARGET + pair("pair3.jpg") + " --false-alarm=2", "--false-alarm"},
        {check + TARGET + pair("pair3.jpg") + " --false-alarm=nan", "--false-alarm"},
    };
    for (const auto& c : cases)
    {
        const ToolResult r = runTool(c.command);
        INFO(c.command << "\n" << r.out << r.err);
        CHECK(r.code == 1);
        CHECK(r.err.find(c.says) != std::string::npos);
        CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
    }
}
