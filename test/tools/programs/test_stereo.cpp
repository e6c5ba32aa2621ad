// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_stereo as a user runs it: on the bundled scene, and on one that refract_simulate renders.
#include "depth_comparison.hpp"
#include "run_tool.hpp"
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <regex>

namespace fs = std::filesystem;

namespace {

const std::string SCENE = paths::bundled() + "/scene";
const std::string CALIB = SCENE + "/truth.yml", LEFT = SCENE + "/glass1/scene.jpg", RIGHT = SCENE + "/glass2/scene.jpg";
const std::string PAIR = " " + LEFT + " " + RIGHT, DEPTH = " --depth=430,1250";

size_t verticesOf(const std::string& cloud)
{
    std::smatch number;
    const std::string header = readFile(cloud).substr(0, 1000);
    return std::regex_search(header, number, std::regex("element vertex (\\d+)")) ? std::stoul(number[1]) : 0;
}

int pixelsWithDepth(const cv::Mat& depth) { return cv::countNonZero(depth == depth); }

//! First number of the line that contains a text.
double numberAfter(const std::string& out, const std::string& text)
{
    const size_t at = out.find(text);
    REQUIRE(at != std::string::npos);
    return std::stod(out.substr(at + text.size()));
}

std::string withoutWindows(std::string calibration)
{
    for (size_t at; (at = calibration.find("   glass_window:")) != std::string::npos; )
        calibration.erase(at, calibration.find('\n', calibration.find("outer_index", at)) + 1 - at);
    return calibration;
}

//! Two cameras one above the other, each behind a pane; what they see is textured and has a true depth.
const char VERTICAL[] = R"(%YAML:1.0
---
camera1:
   image_width: 240
   image_height: 320
   camera_matrix: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 390., 0., 120., 0., 390., 160., 0., 0., 1. ] }
   distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, dt: d, data: [ -0.1, 0.02, 0., 0. ] }
   glass_window: { normal: [ 0.1, 0.19899748742132398, 0.9748846 ], distance: 40., thickness: [ 20. ], index: [ 1.5 ] }
camera2:
   image_width: 240
   image_height: 320
   camera_matrix: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 390., 0., 120., 0., 390., 160., 0., 0., 1. ] }
   distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, dt: d, data: [ -0.1, 0.02, 0., 0. ] }
   glass_window: { normal: [ 0., -0.1, 0.99498744 ], distance: 40., thickness: [ 20. ], index: [ 1.5 ] }
R: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ] }
T: [ 0., -60., 0. ]
exposure: { dark: 15., light: 240., background: 90., blur: 0.6, noise: 1., vignetting: 0. }
seed: 1
texture: { size: 60., contrast: 0.95, octaves: 7 }
scene:
   - { shape: plane, point: [ 0., 0., 700. ], normal: [ 0.1, 0.1, -1. ] }
   - { shape: sphere, center: [ 0., 0., 600. ], radius: 70. }
sets:
   glass: { window: 1, scene: 1 }
)";

//! Fisheye lenses behind flat ports in water: rows of a rectification for one plane are off by 5 px RMS, 63 in the corners.
const char WIDE_IN_WATER[] = R"(%YAML:1.0
---
camera1:
   image_width: 320
   image_height: 240
   lens_model: fisheye
   camera_matrix: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 135., 0., 160., 0., 135., 120., 0., 0., 1. ] }
   distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, dt: d, data: [ 0.01, -0.002, 0.001, 0. ] }
   glass_window: { normal: [ -0.2, -0.07, 0.97729217 ], distance: 60., thickness: [ 25. ], index: [ 1.5 ], outer_index: 1.333 }
camera2:
   image_width: 320
   image_height: 240
   lens_model: fisheye
   camera_matrix: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 135., 0., 160., 0., 135., 120., 0., 0., 1. ] }
   distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, dt: d, data: [ 0.01, -0.002, 0.001, 0. ] }
   glass_window: { normal: [ 0.12, -0.17, 0.97811 ], distance: 60., thickness: [ 25. ], index: [ 1.5 ], outer_index: 1.333 }
R: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ] }
T: [ -100., 0., 0. ]
exposure: { dark: 15., light: 240., background: 90., blur: 0.6, noise: 1., vignetting: 0. }
seed: 1
texture: { size: 120., contrast: 0.95, octaves: 7 }
scene:
   - { shape: plane, point: [ 0., 0., 900. ], normal: [ 0.1, 0.1, -1. ] }
   - { shape: sphere, center: [ 30., 0., 560. ], radius: 130. }
sets:
   glass: { window: 1, scene: 1 }
)";

} // namespace

TEST_CASE("refract_stereo measures a scene behind windows", "[tools][stereo]")
{
    const TemporaryFolder folder;
    const ToolResult result = runTool("refract_stereo " + CALIB + PAIR + DEPTH + " --out=" + (folder / "c.ply") + " --depth-map="
        + (folder / "d.tiff") + " --picture=" + (folder / "p.png") + " --rectified-dir=" + (folder / "r"));
    CAPTURE(result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK(result.err.empty());
    CHECK(result.out.find("rows found, px") != std::string::npos);

    const cv::Mat depth = cv::imread(folder / "d.tiff", cv::IMREAD_UNCHANGED);
    REQUIRE(depth.type() == CV_32F);
    REQUIRE(depth.size() == cv::Size(640, 480));
    CHECK(pixelsWithDepth(depth) > 0.6*depth.total());
    // The spheres' middles, as rig.yml has them: where a ray through the centre meets the front.
    CHECK(std::abs(depth.at<float>(280, 190) - 550) < 8);
    CHECK(std::abs(depth.at<float>(100, 370) - 785) < 10);
    CHECK(verticesOf(folder / "c.ply") > 0.6*depth.total());
    CHECK(readFile(folder / "c.ply").size() > 27*verticesOf(folder / "c.ply"));
    const cv::Mat picture = cv::imread(folder / "p.png");
    CHECK(picture.rows == 480);
    CHECK(picture.cols > 640);
    for (const std::string name : {"left.png", "right.png"})
        CHECK(cv::imread(folder/("r/" + name)).size() == cv::Size(640, 480));
    CHECK(cv::imread(folder / "r/pair.png").size() == cv::Size(2*640 + 8, 480));
    CHECK(cv::imread(folder / "r/disparity.tiff", cv::IMREAD_UNCHANGED).type() == CV_32F);
    CHECK(folder.count() == 4);
}

TEST_CASE("refract_stereo finds the range of depths itself", "[tools][stereo]")
{
    const TemporaryFolder folder;
    const ToolResult result = runTool("refract_stereo " + CALIB + PAIR + " --depth-map=" + (folder / "d.tiff"));
    CAPTURE(result.out, result.err);
    REQUIRE(result.code == 0);
    const double near = numberAfter(result.out, "--depth="), far = numberAfter(result.out, cv::format("--depth=%.4g,", near));
    CHECK(near > 400);
    CHECK(near < 475);
    CHECK(far > 1130);
    CHECK(far < 1350);
    CHECK(pixelsWithDepth(cv::imread(folder / "d.tiff", cv::IMREAD_UNCHANGED)) > 0.6*640*480);
}

TEST_CASE("refract_stereo agrees with the depth that refract_simulate writes, of a vertical rig", "[tools][stereo]")
{
    const TemporaryFolder folder;
    std::string rig = VERTICAL;
    std::ofstream(folder / "rig.yml") << rig;
    const ToolResult rendered = runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "s"));
    INFO(rendered.err);
    REQUIRE(rendered.code == 0);
    const std::string call = "refract_stereo " + (folder / "s/truth.yml") + " " + (folder / "s/glass1/scene.png") + " "
        + (folder / "s/glass2/scene.png") + " --depth=480,850 --depth-map=" + (folder / "d.tiff") + " --out=" + (folder / "c.ply");
    for (const std::string options : {"", " --matcher=hh", " --passes=1", " --block=7"})
    {
        const ToolResult result = runTool(call + options + " --rectified-dir=" + (folder / "r"));
        CAPTURE(options, result.out, result.err);
        REQUIRE(result.code == 0);
        CHECK(result.err.empty());
        const DepthComparison c = compareWithTruth(folder / "s/truth.yml", folder / "d.tiff", folder / "c.ply",
                                                   folder / "s/glass1/scene_depth.tiff");
        CHECK(c.matched > 0.75*c.known);
        CHECK(c.wrong < 0.04*c.matched);
        CHECK(c.rms < 2.5);
        CHECK(c.within > 0.85*c.stated);
    }
    const cv::Mat pair = cv::imread(folder / "r/pair.png");
    CHECK(pair.size() == cv::Size(240, 2*320 + 8));     // one above the other
}

TEST_CASE("Where rows differ by many pixels, the first pass is made in slabs, and what cannot be is left out", "[tools][stereo]")
{
    const TemporaryFolder folder;
    std::ofstream(folder / "rig.yml") << WIDE_IN_WATER;
    const ToolResult rendered = runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "s"));
    INFO(rendered.err);
    REQUIRE(rendered.code == 0);
    const ToolResult result = runTool("refract_stereo " + (folder / "s/truth.yml") + " " + (folder / "s/glass1/scene.png") + " "
        + (folder / "s/glass2/scene.png") + " --depth=400,1200 --depth-map=" + (folder / "d.tiff"));
    CAPTURE(result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK(result.err.empty());      // else the rows would be warned of
    const DepthComparison c = compareDepths(cv::imread(folder / "d.tiff", cv::IMREAD_UNCHANGED),
                                            cv::imread(folder / "s/glass1/scene_depth.tiff", cv::IMREAD_UNCHANGED));
    CHECK(c.matched > 0.65*c.known);
    CHECK(c.wrong < 0.1*c.matched);
}

TEST_CASE("refract_stereo works without any window, if that is said", "[tools][stereo]")
{
    const TemporaryFolder folder;
    std::ofstream(folder / "plain.yml") << withoutWindows(readFile(CALIB));
    const std::string call = "refract_stereo " + (folder / "plain.yml") + " " + SCENE + "/direct1/scene.jpg " + SCENE
        + "/direct2/scene.jpg" + DEPTH + " --out=" + (folder / "c.ply");
    const ToolResult refused = runTool(call), result = runTool(call + " --no-window");
    CAPTURE(refused.err, result.err);
    CHECK(refused.code == 1);
    CHECK(refused.err.find("--no-window") != std::string::npos);
    CHECK(result.code == 0);
    CHECK(result.err.empty());
    CHECK(verticesOf(folder / "c.ply") > 0.6*640*480);
}

TEST_CASE("Depth behind two domes is as dense and as good as without windows", "[tools][stereo][dome][slow]")
{
    const TemporaryFolder folder;
    const std::string inWater = readFile(paths::bundled() + "/dome/scene.yml"), water = "outer_index: 1.333";
    std::string inAir = inWater;
    for (size_t at; (at = inAir.find(water)) != std::string::npos; )
        inAir.replace(at, water.size(), "outer_index: 1.");
    struct Depth { std::string name, rig, set, options; double matched, rms; };
    Depth all[] = { { "none", inAir, "/direct", " --no-window", 0, 0 }, { "in_air", inAir, "/glass", "", 0, 0 },
                    { "in_water", inWater, "/glass", "", 0, 0 } };
    for (Depth& d : all)
    {
        std::ofstream(folder / "rig.yml") << d.rig;
        const ToolResult rendered = runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / d.name));
        INFO(rendered.err);
        REQUIRE(rendered.code == 0);
        std::ofstream(folder / "calib.yml") << (d.name == "none" ? withoutWindows(d.rig) : d.rig);
        const std::string images = folder / (d.name + d.set);
        const ToolResult result = runTool("refract_stereo " + (folder / "calib.yml") + " " + images + "1/scene.png " + images
            + "2/scene.png --depth=400,1300 --depth-map=" + (folder / "d.tiff") + " --out=" + (folder / "c.ply") + d.options);
        CAPTURE(d.name, result.out, result.err);
        REQUIRE(result.code == 0);
        CHECK(result.err.empty());
        const DepthComparison c = compareWithTruth(folder / "calib.yml", folder / "d.tiff", folder / "c.ply",
                                                   images + "1/scene_depth.tiff");
        d.matched = 100.*c.matched/c.known;
        d.rms = c.rms;
        std::cout << "[numbers] dense depth, domes " << d.name << ": " << d.matched << " % matched, " << d.rms << " mm RMS; of no windows "
                  << d.matched/all[0].matched << ", " << d.rms/all[0].rms << std::endl;
        CHECK(c.within > 0.93*c.stated);
        CHECK(d.matched > 0.98*all[0].matched);
        // In water a dome that is not about its camera spreads the view: a pixel is wider there.
        CHECK(d.rms < (d.rig == inWater ? 1.1 : 1.03)*all[0].rms);
    }
}

TEST_CASE("refract_stereo takes folders and videos, skips who is alone, and is quiet", "[tools][stereo]")
{
    const TemporaryFolder folder;
    for (const std::string name : {"l", "r"})
    {
        fs::create_directory(folder/name);
        const std::string& image = name == "l" ? LEFT : RIGHT;
        for (const char* stem : {"a", "b"})
            fs::copy_file(image, folder/(name + "/" + stem + ".jpg"));
    }
    fs::copy_file(LEFT, folder / "l/alone.jpg");
    const std::string call = "refract_stereo " + CALIB + " '" + (folder / "l/*.jpg") + "' '" + (folder / "r/*.jpg") + "'" + DEPTH;
    const ToolResult result = runTool(call + " --quiet --out-dir=" + (folder / "out/deep") + " --rectified-dir="
                                      + (folder / "rect"));
    CAPTURE(result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK(result.out.empty());
    CHECK(result.err.find("'alone'") != std::string::npos);
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
    for (const std::string name : {"a.ply", "b.ply", "a_depth.tiff", "b_depth.tiff", "a_depth.png", "b_depth.png"})
        CHECK(fs::exists(folder/("out/deep/" + name)));
    CHECK(std::distance(fs::directory_iterator(folder / "out/deep"), fs::directory_iterator()) == 6);
    CHECK(fs::exists(folder / "rect/b_disparity.tiff"));
    CHECK(readFile(folder / "out/deep/a.ply") == readFile(folder / "out/deep/b.ply"));

    const ToolResult table = runTool(call + " --out-dir=" + (folder / "table"));
    CHECK(table.out.find("all 2 pairs") != std::string::npos);
    CHECK(readFile(folder / "table/a.ply") == readFile(folder / "out/deep/a.ply"));

    const std::string numbered = "refract_stereo " + CALIB + " " + (folder / "n%d_l.jpg") + " " + (folder / "n%d_r.jpg") + DEPTH
                                 + " --quiet --out-dir=" + (folder / "n");
    CHECK(runTool(numbered).code == 1);
    fs::copy_file(LEFT, folder / "n7_l.jpg");
    fs::copy_file(RIGHT, folder / "n7_r.jpg");
    CHECK(runTool(numbered).code == 0);
    CHECK(fs::exists(folder / "n/frame000007.ply"));
}

TEST_CASE("refract_stereo takes videos, of one length", "[tools][stereo]")
{
    const TemporaryFolder folder;
    const struct { std::string name, image; int frames; } videos[] = {
        {"l.avi", LEFT, 2}, {"r.avi", RIGHT, 2}, {"long.avi", RIGHT, 3}};
    for (const auto& v : videos)
    {
        cv::VideoWriter writer(folder/v.name, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, cv::Size(640, 480));
        REQUIRE(writer.isOpened());
        for (int i = 0; i < v.frames; i++)
            writer.write(cv::imread(v.image));
    }
    const std::string call = "refract_stereo " + CALIB + " " + (folder / "l.avi") + " ", out = " --out-dir=" + (folder / "out");
    const ToolResult result = runTool(call + (folder / "r.avi") + out), longer = runTool(call + (folder / "long.avi") + out),
                     single = runTool(call + (folder / "r.avi") + " --out=" + (folder / "c.ply")),
                     one = runTool(call + (folder / "l.avi") + out);
    CAPTURE(result.out, result.err, longer.err, single.err, one.err);
    CHECK(result.code == 0);
    CHECK(result.err.empty());
    for (const std::string name : {"frame000001.ply", "frame000002.ply", "frame000002_depth.tiff", "frame000002_depth.png"})
        CHECK(fs::exists(folder/("out/" + name)));
    CHECK(longer.code == 1);
    CHECK(longer.err.find("2 and 3") != std::string::npos);
    CHECK(single.code == 1);
    CHECK(single.err.find("--out-dir") != std::string::npos);
    CHECK(one.code == 1);
    CHECK(one.err.find("both cameras") != std::string::npos);
    CHECK(!fs::exists(folder / "c.ply"));
}

TEST_CASE("refract_stereo blames the chessboard, not the calibration, if a chessboard is all there is", "[tools][stereo]")
{
    const TemporaryFolder folder;
    const std::string boards = paths::bundled() + "/stereo";
    const ToolResult result = runTool("refract_stereo " + boards + "/truth.yml " + boards + "/measure1/z600_1.jpg " + boards
                                      + "/measure2/z600_1.jpg --depth=400,1300 --out=" + (folder / "c.ply"));
    CAPTURE(result.err);
    CHECK(result.code == 1);
    CHECK(result.err.find("a pattern that repeats") != std::string::npos);
    CHECK_FALSE(fs::exists(folder / "c.ply"));
}

TEST_CASE("refract_stereo says so if the images do not fit the calibration", "[tools][stereo]")
{
    const TemporaryFolder folder;
    // Camera 2 looks a little higher than when it was calibrated.
    const cv::Mat right = cv::imread(RIGHT);
    for (const double off : {0.6, 1.8})
    {
        cv::Mat shifted;
        cv::warpAffine(right, shifted, cv::Matx23d(1, 0, 0, 0, 1, off), right.size());
        cv::imwrite(folder/cv::format("moved%g.png", 10*off), shifted);
    }
    const std::string call = "refract_stereo " + CALIB + " " + LEFT + " ", out = DEPTH + " --out=" + (folder / "c.ply");
    const ToolResult result = runTool(call + (folder / "moved6.png") + out + " --quiet");
    CAPTURE(result.err);
    CHECK(result.code == 2);
    CHECK(result.err.find("off their rows") != std::string::npos);
    CHECK(result.err.find("a turn of camera 2") != std::string::npos);
    CHECK(fs::exists(folder / "c.ply"));            // written all the same
    fs::remove(folder / "c.ply");
    const ToolResult refused = runTool(call + (folder / "moved18.png") + out);
    CAPTURE(refused.err);
    CHECK(refused.code == 1);
    CHECK(refused.err.find("off their rows") != std::string::npos);
    CHECK_FALSE(fs::exists(folder / "c.ply"));
    const ToolResult good = runTool("refract_stereo " + CALIB + PAIR + DEPTH + " --max-row-error=0.2 --out="
                                    + (folder / "g.ply"));
    CAPTURE(good.err);
    CHECK(good.code == 0);
    CHECK(runTool("refract_stereo " + CALIB + PAIR + DEPTH + " --max-row-error=0.001 --out=" + (folder / "g.ply")).code == 2);
}

TEST_CASE("refract_stereo holds the range of depths against the images", "[tools][stereo]")
{
    const TemporaryFolder folder;
    const std::string call = "refract_stereo " + CALIB + PAIR + " --quiet --depth-map=" + (folder / "d.tiff");
    const ToolResult narrow = runTool(call + " --depth=700,900"), crop = runTool(call + " --depth=700,900 --crop");
    CAPTURE(narrow.err, crop.err);
    CHECK(narrow.code == 2);
    CHECK(narrow.err.find("lies outside") != std::string::npos);
    CHECK(crop.code == 0);
    CHECK(crop.err.empty());
    const cv::Mat depth = cv::imread(folder / "d.tiff", cv::IMREAD_UNCHANGED);
    CHECK(pixelsWithDepth(depth) > 0.15*depth.total());
    CHECK(cv::countNonZero((depth < 700) | (depth > 900)) == 0);
    fs::remove(folder / "d.tiff");
    for (const std::string range : {"1500,3000", "200,400", "5000,inf"})
        for (const std::string how : {"", " --crop"})
        {
            const ToolResult elsewhere = runTool(call + how + " --depth=" + range);
            CAPTURE(range, elsewhere.err);
            CHECK(elsewhere.code == 1);
            CHECK(elsewhere.err.find("give the range of the scene") != std::string::npos);
            CHECK_FALSE(fs::exists(folder / "d.tiff"));
        }
}

TEST_CASE("refract_stereo refuses with one sentence and writes nothing", "[tools][stereo]")
{
    const TemporaryFolder folder;
    const std::string whole = readFile(LEFT);
    std::ofstream(folder / "cut.jpg", std::ios::binary) << whole.substr(0, whole.size()/2);
    std::ofstream(folder / "text.png") << "hello\n";
    std::ofstream(folder / "text.avi") << "hello\n";
    const cv::Mat image = cv::imread(RIGHT);
    cv::Mat half, noise(image.size(), CV_8U);
    cv::resize(image, half, cv::Size(), 0.5, 0.5);
    cv::imwrite(folder / "half.png", half);
    for (const char* name : {"1", "2"})
    {
        cv::imwrite(folder/(std::string("black") + name + ".png"), cv::Mat(image.size(), CV_8U, cv::Scalar(0)));
        cv::imwrite(folder/(std::string("flat") + name + ".png"), cv::Mat(image.size(), CV_8UC3, cv::Scalar(90, 100, 110)));
        cv::randn(noise, 90, 2);
        cv::imwrite(folder/(std::string("noise") + name + ".png"), noise);
    }
    const std::string text = readFile(CALIB);
    std::string small = text, apart = text;
    const size_t second = small.find("camera2:");
    small.replace(small.find("640", second), 3, "320");
    small.replace(small.find("480", second), 3, "240");
    std::ofstream(folder / "small.yml") << small;
    const size_t numbers = apart.find("data", apart.find("\nR:"));       // camera 2 looks the other way
    apart.replace(numbers, apart.find(']', numbers) + 1 - numbers, "data: [ -1., 0., 0., 0., 1., 0., 0., 0., -1. ]");
    std::ofstream(folder / "apart.yml") << apart;
    const std::string one = paths::bundled() + "/stereo/truth.yml";
    std::ofstream(folder / "one.yml") << "%YAML:1.0\n---\n" + std::regex_replace(
        text.substr(text.find("camera1:") + 9, text.find("camera2:") - text.find("camera1:") - 9), std::regex("(^|\n)   "), "$1");
    fs::copy_file(LEFT, folder / "left.jpg");
    const std::string out = " --out=" + (folder / "c.ply"), tool = "refract_stereo " + CALIB + " ";
    const auto images = [&](const std::string& name) {
        return (folder/(name + "1.png")) + " " + (folder/(name + "2.png"));
    };
    struct Case { std::string command, expected; };
    const std::vector<Case> cases = {
        {"refract_stereo " + (folder / "one.yml") + PAIR + DEPTH + out, "one camera"},
        {"refract_stereo " + one + PAIR + DEPTH + out, "1280x1024"},
        {"refract_stereo " + (folder / "small.yml") + " " + LEFT + " " + (folder / "half.png") + DEPTH + out, "of one size"},
        {"refract_stereo " + (folder / "apart.yml") + PAIR + DEPTH + out, ""},
        {"refract_stereo " + (folder / "none.yml") + PAIR + DEPTH + out, "none.yml"},
        {tool + PAIR + DEPTH + " --out=" + (folder / "c.obj"), "the cloud is a .ply"},
        {tool + PAIR + " --depth=400" + out, "as in --depth=400,1200"},
        {tool + LEFT + " " + (folder / "half.png") + DEPTH + out, "320x240"},
        {tool + LEFT + " " + LEFT + DEPTH + out, "both cameras"},
        {tool + LEFT + " " + (folder / "none.png") + DEPTH + out, "none.png"},
        {tool + LEFT + " " + (folder / "text.png") + DEPTH + out, "not an image"},
        {tool + LEFT + " " + (folder / "text.avi") + DEPTH + out, "not a video"},
        {tool + LEFT + " " + (folder / "cut.jpg") + DEPTH + out, "cut short"},
        {tool + LEFT + " " + (folder / "") + DEPTH + out, "folder"},
        {tool + PAIR + " --depth=1250,430" + out, "NEAR < FAR"},
        {tool + PAIR + " --depth=430,430" + out, "NEAR < FAR"},
        {tool + PAIR + " --depth=430" + out, "--depth"},
        {tool + PAIR + " --depth=430,x" + out, "--depth"},
        {tool + PAIR + " --depth=0,400" + out, "NEAR < FAR"},
        {tool + PAIR + " --depth=20,50" + out, "window"},
        {tool + PAIR + " --depth=20,1250" + out, "NEAR=20"},
        {tool + PAIR + " --depth=110,130" + out, "have no common point"},
        {tool + images("black") + DEPTH + out, "looks alike"},
        {tool + images("flat") + DEPTH + out, "looks alike"},
        {tool + images("noise") + DEPTH + out, "looks alike"},
        {tool + images("flat") + out, "--depth=NEAR,FAR"},
        {tool + images("black") + DEPTH + " --out-dir=" + (folder / "dir") + " --rectified-dir=" + (folder / "rect"),
         "looks alike"},
        {tool + PAIR + DEPTH, "--out"},
        {tool + PAIR + DEPTH + out + " --out-dir=" + (folder / "dir"), "--out-dir"},
        {tool + PAIR + DEPTH + " --out=" + (folder / "no/c.ply"), "does not exist"},
        {tool + PAIR + DEPTH + " --depth-map=" + (folder / "d.png"), ".tiff"},
        {tool + PAIR + DEPTH + " --picture=" + (folder / "p.xyz"), "extension"},
        {tool + (folder / "left.jpg") + " " + RIGHT + DEPTH + " --out=" + (folder / "left.jpg"), "overwritten"},
        {tool + PAIR + DEPTH + " --picture=" + (folder / "a.png") + " --out=" + (folder / "a.png"), "written twice"},
        {tool + PAIR + DEPTH + " --block=4" + out, "odd"},
        {tool + PAIR + DEPTH + " --passes=3" + out, "--passes"},
        {tool + PAIR + DEPTH + " --matcher=best" + out, "--matcher"},
        {tool + PAIR + DEPTH + " --max-row-error=0" + out, "--max-row-error"},
        {tool + PAIR + DEPTH + " --no-window" + out, "--no-window"},
        {tool + "'" + SCENE + "/*1/scene.jpg' '" + SCENE + "/*2/scene.jpg'" + DEPTH + " --out-dir=" + (folder / "dir"),
         "equal names"},
        {tool + "'" + (folder / "*1.png") + "' '" + (folder / "*1.png") + "'" + DEPTH + out, "both cameras"},
        {tool + "'" + (folder / "*1.png") + "' '" + (folder / "*2.png") + "'" + DEPTH + out, "equal names"},
    };
    const size_t files = folder.count();
    for (const Case& c : cases)
    {
        const ToolResult result = runTool(c.command);
        CAPTURE(c.command, result.out, result.err);
        CHECK(result.code == 1);
        CHECK(result.err.find(c.expected) != std::string::npos);
        CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
        CHECK(folder.count() == files);
    }
}
