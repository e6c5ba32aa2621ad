// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_laser as a user runs it: real images in water, and what it refuses.
#include "run_tool.hpp"
#include <catch2/catch.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <cmath>
#include <filesystem>
#include <iostream>

namespace {

double numberAfter(const std::string& text, const std::string& words)
{
    const size_t at = text.find(words);
    return at == std::string::npos ? NAN : std::stod(text.substr(at + words.size()));
}

} // namespace

TEST_CASE("refract_laser calibrates a sheet in water, real images", "[laser_tool][real][slow]")
{
    const std::string data = paths::data() + "/ouc_laser3d";
    if (!std::filesystem::exists(data))
    {
        WARN("SKIPPED: no " << data);
        return;
    }
    const TemporaryFolder folder;
    const ToolResult camera = runTool("refract_calib --size=8x7 --partial --square=33.8 --direct='" + data + "/air/*.png' --glass='" + data
        + "/water/*.png' --unpaired --outer-index=1.333 --free=distance --no-cross-validation --quiet --out=" + (folder / "calib.yml"));
    CAPTURE(camera.err);
    REQUIRE(camera.code == 0);
    const std::string board = " --size=8x7 --partial --square=33.8 ";
    const ToolResult sheet = runTool("refract_laser " + (folder / "calib.yml") + " '" + data + "/water/*.png'" + board
        + "--picture-dir=" + (folder / "pictures") + " --sheet-out=" + (folder / "sheet.yml"));
    CAPTURE(sheet.out, sheet.err);
    REQUIRE(sheet.code == 0);
    const double rms = numberAfter(sheet.out, "Each board held out: "), ratio = numberAfter(sheet.out, "(RMS),\n  ");
    std::cout << "[numbers] ouc_laser3d, water: sheet of light, each board held out " << rms << " mm RMS, " << ratio << " x stated\n";
    CHECK(mentions(sheet.out, "12 of 13 boards"));
    CHECK(rms < 0.5);
    CHECK(ratio > 0.8);
    CHECK(ratio < 1.25);
    CHECK(std::filesystem::exists(folder / "pictures/bc1.png"));

    // The points of a board that was measured with the sheet.
    const ToolResult points = runTool("refract_laser " + (folder / "calib.yml") + " '" + data + "/water/bc1.png' --sheet="
        + (folder / "sheet.yml") + " --out=" + (folder / "points.csv") + " --cloud=" + (folder / "cloud.ply"));
    CAPTURE(points.err);
    CHECK(points.code == 0);
    CHECK(readFile(folder / "points.csv").compare(0, 39, "image,id,u1,v1,x,y,z,sx,sy,sz,status\nbc") == 0);
    CHECK(mentions(readFile(folder / "cloud.ply"), "property float sx"));
    CHECK_FALSE(mentions(points.out, "nan"));

    const ToolResult limit = runTool("refract_laser " + (folder / "calib.yml") + " '" + data + "/water/*.png'" + board
        + "--max-rms=0.01 --quiet --sheet-out=" + (folder / "sheet2.yml"));
    CHECK(limit.code == 2);
    CHECK(mentions(limit.err, "limit not met"));
    CHECK(readFile(folder / "sheet2.yml").size() > 100);        // written all the same

    // A line that is an edge of the board: red light is not there.
    const ToolResult red = runTool("refract_laser " + (folder / "calib.yml") + " '" + data + "/water/bc[12].png'" + board
        + "--laser=red --quiet --sheet-out=" + (folder / "sheet3.yml"));
    CHECK(red.code != 0);
    CHECK_FALSE(std::filesystem::exists(folder / "sheet3.yml"));
}

namespace {

//! A small camera, and images without a board.
void writeSmallCamera(const TemporaryFolder& folder)
{
    writeFile(folder / "calib.yml", "%YAML:1.0\n---\nimage_width: 64\nimage_height: 48\n"
        "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n"
        "   dt: d\n   data: [ 80, 0, 32, 0, 80, 24, 0, 0, 1 ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 4\n   dt: d\n"
        "   data: [ 0, 0, 0, 0 ]\nglass_window:\n   normal: [ 0., 0., 1. ]\n   distance: 10.\n   thickness: [ 5. ]\n   index: [ 1.5 ]\n"
        "   inner_index: 1.\n   outer_index: 1.333\n");
    cv::imwrite(folder / "grey.png", cv::Mat(48, 64, CV_8U, cv::Scalar(20)));
    cv::imwrite(folder / "colour.png", cv::Mat(48, 64, CV_8UC3, cv::Scalar(20, 20, 20)));
}

//! A sheet that crosses the small camera's view, from y = -300 at z = 0 to 300 at z = 2000.
void writeSheetOfSmallCamera(const TemporaryFolder& folder)
{
    const double length = std::hypot(1., 0.3);
    cv::FileStorage fs(folder / "good.yml", cv::FileStorage::WRITE);
    fs << "sheet_plane" << std::vector<double>{0., 1/length, -0.3/length, -300/length}
       << "covariance" << cv::Mat(cv::Mat::eye(4, 4, CV_64F)*1e-6)
       << "by_parameters" << cv::Mat(cv::Mat::zeros(4, 16, CV_64F)) << "line_scale_px" << 1.5
       << "line_noise_px" << 0.05 << "laser" << "green"
       << "depth" << std::vector<double>{400, 1600} << "unit" << ""
       << "camera_parameters" << std::vector<double>{80, 80, 32, 24, 0, 0, 0, 0, 0, 0, 1, 10, 1, 1.333, 5, 1.5};
}

} // namespace

TEST_CASE("refract_laser says that the line is at other depths than --depth", "[laser_tool]")
{
    const TemporaryFolder folder;
    writeSmallCamera(folder);
    writeSheetOfSmallCamera(folder);
    cv::Mat image(48, 64, CV_8UC3, cv::Scalar(20, 20, 20));
    cv::line(image, cv::Point(0, 20), cv::Point(63, 20), cv::Scalar(20, 220, 20), 2);
    cv::GaussianBlur(image, image, cv::Size(), 1.2);
    cv::imwrite(folder / "line.png", image);
    const std::string call = "refract_laser " + (folder / "calib.yml") + " '" + (folder / "line.png") + "' --sheet="
        + (folder / "good.yml") + " --out=" + (folder / "points.csv");
    const ToolResult all = runTool(call), none = runTool(call + " --depth=1,2");
    CAPTURE(all.err, none.err);
    CHECK(all.code == 0);
    CHECK(none.code == 1);
    CHECK(mentions(none.err, "points of a line are at z "));
    CHECK(mentions(none.err, "outside --depth=1,2"));
    CHECK_FALSE(mentions(none.err, "colour"));
}

TEST_CASE("refract_laser says what is wrong with an emitter", "[laser_tool]")
{
    const TemporaryFolder folder;
    writeSmallCamera(folder);
    const std::string good = readFile(paths::bundled() + "/laser/emitter.yml");
    const auto replaced = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        REQUIRE(text.find(from) != std::string::npos);
        return text.replace(text.find(from), from.size(), to);
    };
    const struct { std::string text, sentence; } cases[] = {
        {"", "cannot read"}, {replaced("line:", "lines:"), "no key 'lines'"}, {replaced("rvec:", "rotation:"), "no key 'rotation'"},
        {replaced("line: 200.", "line: .nan"), "'line'"}, {replaced("tvec:", "# "), "'tvec' is missing"},
        {replaced("rotation_std_deg: 1.5", "rotation_std_deg: 0."), "'rotation_std_deg'"},
        {replaced("position_std: 4.", "position_std: .nan"), "'position_std'"},
        {replaced("normal_deg: [ 0.3, 0.3 ]", "normal_deg: [ 0.3 ]"), "'normal_deg'"},
        {replaced("index: [ 1.52 ]", "index: [ 0.52 ]"), "index"}, {replaced("distance: 1.", "distance: -1."), "'distance'"},
        {good, "not found in any image"}};
    for (const auto& c : cases)
    {
        writeFile(folder / "emitter.yml", c.text);
        const ToolResult result = runTool("refract_laser " + (folder / "calib.yml") + " '" + (folder / "colour.png")
            + "' --size=8x7 --square=20 --emitter=" + (folder / "emitter.yml") + " --sheet-out=" + (folder / "s.yml"));
        CAPTURE(c.sentence, result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, c.sentence));
        CHECK_FALSE(std::filesystem::exists(folder / "s.yml"));
    }
}

TEST_CASE("refract_laser says what is wrong", "[laser_tool]")
{
    const TemporaryFolder folder;
    writeSmallCamera(folder);
    writeFile(folder / "sheet.yml", "%YAML:1.0\n---\nplane: 1\n");
    const std::string calib = "refract_laser " + (folder / "calib.yml") + " ", colour = "'" + (folder / "colour.png") + "' ";
    // What --laser-off differs in, of images of one camera.
    std::filesystem::create_directories(folder / "off");
    std::filesystem::create_directories(folder / "on");
    const auto pairOf = [&](const std::string& name, const cv::Mat& on, const cv::Mat& off) {
        cv::imwrite(folder / "on/" + name, on);
        cv::imwrite(folder / "off/" + name, off);
        return "'" + (folder / "on/" + name) + "' --laser-off='" + (folder / "off/" + name) + "' --sheet=" + (folder / "good.yml");
    };
    writeSheetOfSmallCamera(folder);
    const cv::Mat lit(48, 64, CV_8UC3, cv::Scalar(20, 20, 20));
    const struct { std::string arguments, sentence; } cases[] = {
        {pairOf("grey.png", lit, cv::Mat(48, 64, CV_8U, cv::Scalar(20))), "differ in colour"},
        {pairOf("size.png", lit, cv::Mat(40, 64, CV_8UC3, cv::Scalar(20, 20, 20))), "differ in size (64x40, 64x48)"},
        {pairOf("deep.png", lit, cv::Mat(48, 64, CV_16UC3, cv::Scalar(20, 20, 20))), "differ in bits of a value (16, 8)"},
        {colour, "--sheet-out"},
        {colour + "--sheet-out=" + (folder / "s.yml"), "--size and --square"},
        {colour + "--size=4x3 --square=5 --sheet-out=" + (folder / "s.txt"), ".yml"},
        {colour + "--size=4x3 --square=5 --sheet-out=" + (folder / "s.yml"), "not found in any image"},
        {colour + "--sheet=" + (folder / "none.yml"), "cannot read"},
        {colour + "--sheet=" + (folder / "sheet.yml"), "not a sheet of light"},
        {colour + "--sheet=" + (folder / "sheet.yml") + " --sheet-out=" + (folder / "s.yml"), "--sheet-out"},
        {colour + "--emitter=e.yml --sheet=" + (folder / "sheet.yml"), "--sheet-out"},
        {colour + "--laser=violet --sheet=" + (folder / "sheet.yml"), "--laser"},
        {"'" + (folder / "no*.png") + "' --sheet=" + (folder / "sheet.yml"), "sheet"}};
    for (const auto& c : cases)
    {
        const ToolResult result = runTool(calib + c.arguments);
        CAPTURE(c.arguments, result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, c.sentence));
        CHECK_FALSE(std::filesystem::exists(folder / "s.yml"));
    }
}
