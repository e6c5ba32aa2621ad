// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_simulate as a user runs it: what it renders is where it says, for every pattern, and found again in every image.
#include "run_tool.hpp"
#include "truth_file.hpp"
#include <catch2/catch.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/refract.hpp>

namespace {

//! One camera of 640x512 behind a tilted pane, the target upright, tilted, and upside down.
std::string scene(const std::string& target, const std::string& sets, int seed = 1)
{
    return "%YAML:1.0\n---\ntarget: " + target + R"(
image_width: 640
image_height: 512
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 1200., 0., 320., 0., 1200., 250., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.2, 0.1, 0.001, 0., 0. ]
glass_window: { normal: [ -0.24, 0.1, 0.965 ], distance: 50., thickness: [ 20. ], index: [ 1.5 ], inner_index: 1., outer_index: 1. }
exposure: { noise: 1., blur: 0.6 }
seed: )" + std::to_string(seed) + R"(
poses:
   fixed:
      - { rvec: [ 0., 0., 0. ], tvec: [ -100., -80., 650. ] }
      - { rvec: [ 0.3, -0.3, 0.1 ], tvec: [ -100., -80., 650. ] }
      - { rvec: [ 0.05, 0., 3.1 ], tvec: [ 100., 80., 650. ] }
   drawn: { count: 2, distance: [ 600., 700. ], tilt_deg: [ 0., 30. ], roll_deg: 180., margin: 20. }
sets:
)" + sets;
}

const char* const CHESSBOARD = "{ pattern: chessboard, size: \"6x5\", square: 39. }";

//! One sentence, with a text in it. @param unwritten in the folder
void checkRefused(const TemporaryFolder& folder, const std::string& file, const std::string& expected, const std::string& unwritten)
{
    writeFile(folder / "rig.yml", file);
    const ToolResult result = runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "out"));
    CAPTURE(file, expected, result.err);
    CHECK(result.code == 1);
    CHECK(result.err.find(expected) != std::string::npos);
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
    CHECK(!std::filesystem::exists(folder / unwritten));
}

//! Two small cameras behind panes and what they see; lines of `shapes` and `sets` as in the file.
std::string texturedScene(const std::string& shapes, const std::string& sets, int seed = 1)
{
    const auto camera = [](const std::string& name, const std::string& normal) {
        return name + R"(:
   image_width: 160
   image_height: 120
   camera_matrix: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 200., 0., 80., 0., 200., 60., 0., 0., 1. ] }
   distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, dt: d, data: [ -0.2, 0.1, 0.001, 0. ] }
   glass_window: { normal: )" + normal + R"(, distance: 50., thickness: [ 25. ], index: [ 1.517 ] }
)";
    };
    return "%YAML:1.0\n---\n" + camera("camera1", "[ -0.2, 0.1, 0.97 ]") + camera("camera2", "[ 0.15, -0.15, 0.97 ]")
        + "R: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ]\nT: [ -150., 0., 0. ]\nseed: " + std::to_string(seed)
        + "\ntexture: { size: 60., contrast: 0.8, octaves: 8 }\nscene:\n" + shapes + "sets:\n" + sets;
}

const char* const SHAPES = "   - { shape: plane, point: [ 0., 0., 1100. ], normal: [ 0.1, 0., -1. ] }\n"
                           "   - { shape: sphere, center: [ 50., 0., 700. ], radius: 100., color: [ 1., 0.7, 0.5 ] }\n";
const char* const SCENE_SETS = "   direct: { window: 0, scene: 1 }\n   glass: { window: 1, scene: 1 }\n";

} // namespace

TEST_CASE("a window whose faces are not parallel is rendered, measured through, and kept in files", "[tools][simulate][wedge]")
{
    const TemporaryFolder folder;
    const std::string parallel = scene(CHESSBOARD, "   glass: { window: 1, poses: [ fixed ] }\n"), end = "outer_index: 1.";
    std::string rig = parallel;
    rig.replace(rig.find(end), end.size(), end + ", wedge: [ [ 0.02, -0.01 ] ]");
    writeFile(folder / "rig.yml", rig);
    writeFile(folder / "parallel.yml", parallel);
    REQUIRE(runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "out")).code == 0);
    REQUIRE(runTool("refract_simulate " + (folder / "parallel.yml") + " --out-dir=" + (folder / "without")).code == 0);
    CHECK(readFile(folder / "out/truth.yml").find("wedge:") != std::string::npos);
    CHECK(readFile(folder / "without/truth.yml").find("wedge") == std::string::npos);
    const auto truth = readTruth(folder / "out"), other = readTruth(folder / "without");
    const std::string name = "glass/fixed1.png";
    REQUIRE(runTool("refract_measure " + (folder / "out/truth.yml") + " " + (folder / "out/") + name + " --size=6x5 --square=39 --out="
                    + (folder / "points.csv")).code == 0);
    for (const CsvRow& row : readPointsCsv(readFile(folder / "points.csv")))
    {
        CHECK(cv::norm(row.pixel1 - truth.at(name).pixels[row.id]) < 0.2);
        CHECK(cv::norm(other.at(name).pixels[row.id] - truth.at(name).pixels[row.id]) > 5.);
    }
}

TEST_CASE("boards that moved between two sets are rendered where they are then", "[tools][simulate]")
{
    const TemporaryFolder folder;
    writeFile(folder / "rig.yml", scene(CHESSBOARD, "   direct: { window: 0, poses: [ fixed ] }\n"
        "   moved: { window: 0, poses: [ fixed ], motion: { rvec: [ 0., 0., 0. ], tvec: [ 1., 0., 0. ] } }\n"));
    REQUIRE(runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "out")).code == 0);
    const auto truth = readTruth(folder / "out");
    const TrueView& before = truth.at("direct/fixed1.png");
    const TrueView& after = truth.at("moved/fixed1.png");
    CHECK(cv::norm(after.tvec - before.tvec - cv::Vec3d(1, 0, 0)) < 1e-12);
    CHECK(after.pixels[0].x - before.pixels[0].x > 1.5);    // a millimetre
    // As refract_calib takes them: where the boards were first.
    CHECK(mentions(readFile(folder / "out/poses.csv"), ",-100,-80,650"));
    writeFile(folder / "bad.yml", scene(CHESSBOARD, "   moved: { window: 0, poses: [ fixed ], motion: { rvec: [ 0. ] } }\n"));
    const ToolResult bad = runTool("refract_simulate " + (folder / "bad.yml") + " --out-dir=" + (folder / "no"));
    CHECK(bad.code == 1);
    CHECK(mentions(bad.err, "motion"));
}

TEST_CASE("rendered targets are found where the truth says, numbered alike however they are turned", "[tools][simulate]")
{
    struct Kind { std::string target, options; int count; bool turned; double limit; };
    for (const Kind& kind : {Kind{CHESSBOARD, "--size=6x5 --square=39", 30, true, 0.05},
                             Kind{"{ pattern: acircles, size: \"4x7\", square: 25. }",
                                  "--pattern=acircles --size=4x7 --square=25", 28, false, 0.02},
                             Kind{"{ pattern: charuco, size: \"6x5\", square: 39., marker: 30. }",
                                  "--pattern=charuco --size=6x5 --square=39 --marker=30", 30, true, 0.1},
                             Kind{"{ pattern: circles, size: \"6x5\", square: 39. }",
                                  "--pattern=circles --size=6x5 --square=39", 30, false, 0.02},
                             Kind{"{ pattern: aprilgrid, size: \"4x3\", square: 38. }",
                                  "--pattern=aprilgrid --size=4x3 --square=38", 48, true, 0.1}})
    {
        const TemporaryFolder folder;
        writeFile(folder / "rig.yml", scene(kind.target, "   glass: { window: 1, poses: [ fixed ] }\n"));
        const ToolResult rendered = runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "out"));
        CAPTURE(kind.options, rendered.err);
        REQUIRE(rendered.code == 0);
        const auto truth = readTruth(folder / "out");
        REQUIRE(truth.size() == 3);
        for (const int i : {1, 2, 3})
        {
            if (i == 3 && !kind.turned)     // a symmetric grid upside down looks as the right way up
                continue;
            const std::string name = "glass/fixed" + std::to_string(i) + ".png";
            const ToolResult measured = runTool("refract_measure " + (folder / "out/truth.yml") + " "
                + (folder / "out/") + name + " " + kind.options + " --out=" + (folder / "points.csv"));
            CAPTURE(name, measured.err);
            REQUIRE(measured.code == 0);
            const std::vector<CsvRow> rows = readPointsCsv(readFile(folder / "points.csv"));
            REQUIRE((int)rows.size() == kind.count);
            double squares = 0;
            for (const CsvRow& row : rows)
                squares += std::pow(cv::norm(row.pixel1 - truth.at(name).pixels[row.id]), 2);
            std::cout << "[numbers] " << kind.options << ", " << name << ": " << std::sqrt(squares/rows.size()) << " px RMS\n";
            // The middle of a tilted dot's image, which is not the image of its middle, is up to radius^2 * tilt / f = 0.3 px off.
            CHECK(std::sqrt(squares/rows.size()) < kind.limit);
        }
    }
}

TEST_CASE("An AprilGrid from rendered images to a calibration", "[tools][simulate][aprilgrid]")
{
    const TemporaryFolder folder;
    const std::string sets = "   direct: { window: 0, poses: [ fixed, drawn ] }\n   glass: { window: 1, poses: [ fixed, drawn ] }\n";
    writeFile(folder / "rig.yml", scene("{ pattern: aprilgrid, size: \"4x3\", square: 38. }", sets));
    REQUIRE(runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "out")).code == 0);
    const ToolResult calib = runTool("refract_calib --pattern=aprilgrid --size=4x3 --square=38 --direct='" + (folder / "out/direct/*.png")
                                     + "' --glass='" + (folder / "out/glass/*.png") + "' --camera=" + (folder / "out/truth.yml")
                                     + " --thickness=20 --index=1.5 --no-cross-validation --out=" + (folder / "calib.yml"));
    CAPTURE(calib.out, calib.err);
    REQUIRE(calib.code == 0);
    const cv::Vec3d found = cv::refract::RefractiveCamera::read(folder / "calib.yml")->window().normal,
                truth = cv::refract::RefractiveCamera::read(folder / "out/truth.yml")->window().normal;
    const double degrees = std::acos(std::min(1., found.dot(truth)))*180/CV_PI;
    std::cout << "[numbers] AprilGrid, five rendered pairs: normal " << degrees << " degrees off\n";
    CHECK(degrees < 0.5);
}

TEST_CASE("a chessboard of another size than --size is told from, soon", "[tools][simulate]")
{
    const TemporaryFolder folder;
    writeFile(folder / "rig.yml", scene("{ pattern: chessboard, size: \"9x6\", square: 22. }",
                                    "   glass: { window: 1, poses: [ fixed ] }\n   direct: { window: 0, poses: [ drawn, fixed ] }\n"));
    REQUIRE(runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "out")).code == 0);
    const std::string measure = "refract_measure " + (folder / "out/truth.yml") + " '" + (folder / "out/glass/*") + "' --square=22";
    CHECK(runTool(measure + " --size=9x6").code == 0);
    for (const std::string size : {"10x7", "8x5", "9x5", "6x8"})
    {
        const auto start = std::chrono::steady_clock::now();
        const ToolResult result = runTool(measure + " --size=" + size);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        INFO(size << "\n" << result.err);
        CHECK(result.code == 1);
        CHECK(result.err.find("--size=9x6") != std::string::npos);
        std::cout << "[numbers] 9x6 board called " << size << ": refused after " << seconds << " s (3 images)\n";
    }

    // One odd-sized image among many is to blame, wherever it stands.
    for (const std::string name : {"a.png", "e.png", "z.png"})
    {
        cv::imwrite(folder/("out/direct/" + name), cv::Mat(480, 600, CV_8U, cv::Scalar(90)));
        const ToolResult odd = runTool("refract_calib --size=9x6 --square=22 --thickness=20 --index=1.5 --unpaired --direct='"
            + (folder / "out/direct/*") + "' --glass='" + (folder / "out/glass/*") + "' --out=" + (folder / "calib.yml"));
        std::filesystem::remove(folder/("out/direct/" + name));
        INFO(odd.err);
        CHECK(odd.code == 1);
        CHECK(odd.err.find(name + "' is 600x480 pixels, 5 other images are 640x512") != std::string::npos);
    }
}

TEST_CASE("the same scene gives the same images, another seed gives others", "[tools][simulate]")
{
    const TemporaryFolder folder;
    const std::string sets = "   direct: { window: 0, poses: [ drawn ] }\n   glass: { window: 1, poses: [ drawn ] }\n";
    writeFile(folder / "rig.yml", scene(CHESSBOARD, sets));
    writeFile(folder / "other.yml", scene(CHESSBOARD, sets, 2));
    for (const std::string name : {"a", "b"})
        REQUIRE(runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder/name)).code == 0);
    REQUIRE(runTool("refract_simulate " + (folder / "other.yml") + " --format=jpg --out-dir=" + (folder / "c")).code == 0);
    CHECK(readFile(folder / "a/glass/drawn1.png") == readFile(folder / "b/glass/drawn1.png"));
    CHECK(readFile(folder / "a/glass/drawn1.png") != readFile(folder / "a/direct/drawn1.png"));
    const auto a = readTruth(folder / "a"), c = readTruth(folder / "c");
    REQUIRE(a.size() == 4);
    CHECK(a.at("glass/drawn2.png").tvec == a.at("direct/drawn2.png").tvec);
    CHECK(cv::norm(a.at("glass/drawn2.png").tvec - c.at("glass/drawn2.jpg").tvec) > 1);
    for (const auto& view : a)
        for (const cv::Point2d& p : view.second.pixels)
            CHECK(cv::Rect2d(20, 20, 600, 472).contains(p));
}

TEST_CASE("a textured scene: images and depth of each camera, with window and without", "[tools][simulate]")
{
    const TemporaryFolder folder;
    writeFile(folder / "rig.yml", texturedScene(SHAPES, SCENE_SETS));
    const ToolResult rendered = runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "out"));
    INFO(rendered.err);
    REQUIRE(rendered.code == 0);
    CHECK(rendered.out.find("4 images") != std::string::npos);
    const cv::FileStorage truth(folder / "out/truth.yml", cv::FileStorage::READ);
    CHECK(truth["views"].empty());
    CHECK(truth["target"].empty());
    REQUIRE(truth["scene_views"].size() == 4);
    std::map<std::string, cv::Mat> images, depths;
    for (const cv::FileNode& view : truth["scene_views"])
    {
        const std::string name = (std::string)view["set"] + std::to_string((int)view["camera"]);
        CHECK((std::string)view["file"] == name + "/scene.png");
        CHECK((std::string)view["depth"] == name + "/scene_depth.tiff");
        CHECK((int)view["window"] == (name[0] == 'g'));
        images[name] = cv::imread(folder/("out/" + name + "/scene.png"), cv::IMREAD_UNCHANGED);
        depths[name] = cv::imread(folder/("out/" + name + "/scene_depth.tiff"), cv::IMREAD_UNCHANGED);
        REQUIRE(images[name].type() == CV_8UC3);
        REQUIRE(depths[name].type() == CV_32F);
        CHECK(images[name].size() == cv::Size(160, 120));
        CHECK(depths[name].size() == cv::Size(160, 120));
        CHECK(cv::checkRange(depths[name], true, nullptr, 500, 1400));
    }
    CHECK(cv::norm(images["glass1"], images["direct1"], cv::NORM_INF) > 30);
    CHECK(cv::norm(depths["glass1"], depths["direct1"], cv::NORM_INF) > 5);

    // The cameras are parallel: a sphere's nearest point is that of both.
    double nearest1, nearest2;
    cv::minMaxLoc(depths["direct1"], &nearest1);
    cv::minMaxLoc(depths["direct2"], &nearest2);
    CHECK(std::abs(nearest1 - nearest2) < 0.2);
    CHECK(nearest1 < 602);

    // What refract_simulate wrote is a calibration, too.
    const auto camera1 = cv::refract::RefractiveCamera::read(folder / "out/truth.yml", "camera1");
    std::vector<cv::Point2d> pixel = {{10, 10}}, normalized;
    const double z = depths["glass1"].at<float>(10, 10);
    cv::refract::refractiveUndistortPoints(pixel, normalized, camera1, std::vector<double>{z});
    CHECK(std::abs(0.1*z*normalized[0].x - (z - 1100)) < 1e-3);
}

TEST_CASE("the same textured scene gives the same bytes, another seed another texture", "[tools][simulate]")
{
    const TemporaryFolder folder;
    writeFile(folder / "rig.yml", texturedScene(SHAPES, SCENE_SETS));
    writeFile(folder / "other.yml", texturedScene(SHAPES, SCENE_SETS, 2));
    for (const std::string name : {"a", "b"})
        REQUIRE(runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder/name)).code == 0);
    REQUIRE(runTool("refract_simulate " + (folder / "other.yml") + " --out-dir=" + (folder / "c")).code == 0);
    for (const std::string file : {"glass1/scene.png", "glass1/scene_depth.tiff", "direct2/scene.png"})
        CHECK(readFile(folder/("a/" + file)) == readFile(folder/("b/" + file)));
    const cv::Mat a = cv::imread(folder / "a/direct1/scene.png"), c = cv::imread(folder / "c/direct1/scene.png");
    CHECK(cv::norm(a, c, cv::NORM_L1)/(a.total()*3) > 10);
    CHECK(readFile(folder / "a/glass1/scene_depth.tiff") == readFile(folder / "c/glass1/scene_depth.tiff"));
}

TEST_CASE("target and scene stand in one file", "[tools][simulate]")
{
    const TemporaryFolder folder;
    std::string text = scene(CHESSBOARD, "   glass: { window: 1, poses: [ fixed ] }\n   room: { window: 1, scene: 1 }\n");
    text += "texture: { size: 60. }\nscene:\n   - { shape: plane, point: [ 0., 0., 600. ], normal: [ 0., 0., 1. ], right: [ 1., 0., 0. ], "
            "half_size: [ 80., 80. ] }\n";
    writeFile(folder / "rig.yml", text);
    REQUIRE(runTool("refract_simulate " + (folder / "rig.yml") + " --format=jpg --out-dir=" + (folder / "out")).code == 0);
    CHECK(readTruth(folder / "out").size() == 3);
    const cv::FileStorage truth(folder / "out/truth.yml", cv::FileStorage::READ);
    REQUIRE(truth["scene_views"].size() == 1);
    CHECK((std::string)truth["scene_views"][0]["file"] == "room/scene.jpg");
    const cv::Mat depth = cv::imread(folder / "out/room/scene_depth.tiff", cv::IMREAD_UNCHANGED);
    const int seen = cv::countNonZero(cv::abs(depth - 600) < 1e-3), missed = 640*512 - cv::countNonZero(depth == depth);
    CHECK(seen + missed == 640*512);
    CHECK((seen > 60000 && missed > 60000));
    CHECK(!cv::imread(folder / "out/room/scene.jpg").empty());
}

TEST_CASE("refract_simulate refuses textured scenes it cannot render, with one sentence", "[tools][simulate]")
{
    const TemporaryFolder folder;
    const std::string good = texturedScene(SHAPES, SCENE_SETS);
    const auto replaced = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.find(from), from.size(), to);
    };
    const auto shape = [](const std::string& keys) { return texturedScene("   - { " + keys + " }\n", SCENE_SETS); };
    struct Case { std::string text, expected; };
    for (const Case& c : {Case{replaced("scene:\n", "scenery:\n"), "no 'target' and no 'scene'"},
                          Case{replaced("texture:", "textur:"), "is it 'texture'?"},
                          Case{replaced("size: 60.", "size: 0."), "texture: 'size'"},
                          Case{replaced("size: 60., ", ""), "texture: 'size'"},
                          Case{replaced("contrast: 0.8", "contrast: 1.8"), "'contrast'"},
                          Case{replaced("octaves: 8", "octaves: 0"), "'octaves'"},
                          Case{replaced("octaves: 8", "octave: 8"), "no key 'octave'; it takes size, contrast, octaves"},
                          Case{texturedScene("   3\n", SCENE_SETS), "'scene' must be a list"},
                          Case{texturedScene("   - 3\n", SCENE_SETS), "scene, shape 1 must be keys"},
                          Case{shape("shape: cube"), "'shape' must be plane or sphere"},
                          Case{shape("shape: 1"), "'shape' must be a text"},
                          Case{shape("shape: plane, point: [ 0., 0., 900. ]"), "shape 1: 'normal' must be a list of 3"},
                          Case{shape("shape: plane, point: [ 0., 900. ], normal: [ 0., 0., 1. ]"), "'point'"},
                          Case{shape("shape: plane, point: [ 0., 0., 900. ], normal: [ 0., 0., 0. ]"), "'normal' must not be 0"},
                          Case{shape("shape: plane, point: [ 0., 0., 900. ], normal: [ 0., 0., 1. ], half_size: [ 1., 1. ]"),
                               "'right' and 'half_size'"},
                          Case{shape("shape: plane, point: [ 0., 0., 900. ], normal: [ 0., 0., 1. ], half_size: [ 1., -1. ], "
                                     "right: [ 1., 0., 0. ]"), "'half_size' must be"},
                          Case{shape("shape: plane, point: [ 0., 0., 900. ], normal: [ 0., 0., 1. ], half_size: [ 1., 1. ], "
                                     "right: [ 0., 0., 2. ]"), "'right' must not be along"},
                          Case{shape("shape: sphere, center: [ 0., 0., 900. ], radius: -1."), "'radius'"},
                          Case{shape("shape: sphere, center: [ 0., 0., 900. ], radus: 1."), "no key 'radus'"},
                          Case{shape("shape: sphere, center: [ 0., 0., 9. ], radius: 9., color: [ 1., 2., 0. ]"), "'color'"},
                          Case{shape("shape: sphere, center: [ 0., 0., -900. ], radius: 9."),
                               "set 'direct': camera 1 sees nothing"},
                          Case{shape("shape: plane, point: [ 0., 0., 20. ], normal: [ 0., 0., 1. ]"),
                               "set 'glass': camera 1 sees nothing"},
                          Case{shape("shape: sphere, center: [ -300., 0., 900. ], radius: 9."), "camera 2 sees nothing"},
                          Case{texturedScene(SHAPES, "   direct: { window: 0, scene: 1, poses: [ a ] }\n"), "either 'poses'"},
                          Case{texturedScene(SHAPES, "   direct: { window: 0, scene: 0 }\n"), "either 'poses'"},
                          Case{texturedScene(SHAPES, "   direct: 1\n"), "sets: direct must be keys"},
                          Case{texturedScene(SHAPES, "   direct: { window: 0, poses: [ a ] }\n"), "no poses called 'a'"},
                          Case{good + "poses:\n   a: [ { rvec: [ 0., 0., 0. ], tvec: [ 0., 0., 600. ] } ]\n",
                               "are of a 'target'"},
                          Case{scene(CHESSBOARD, "   room: { window: 1, scene: 1 }\n"), "renders the 'scene' of the file"}})
        checkRefused(folder, c.text, c.expected, "out");        // no depth without its image either
}

TEST_CASE("refract_simulate refuses scenes it cannot render, with one sentence", "[tools][simulate]")
{
    const TemporaryFolder folder;
    const std::string sets = "   glass: { window: 1, poses: [ fixed ] }\n";
    const std::string good = scene(CHESSBOARD, sets);
    const auto replaced = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.find(from), from.size(), to);
    };
    struct Case { std::string text, expected; };
    for (const Case& c : {Case{"", "rig.yml"}, Case{"%YAML:1.0\n---\na: 1\n", "camera_matrix"},
                          Case{good.substr(0, 300), "rig.yml"},
                          Case{scene(CHESSBOARD, "   glass: { window: 1, poses: [ none ] }\n"), "none"},
                          Case{scene("{ pattern: charuco, size: \"6x5\", square: 39., dictionary: X }", sets),
                               "dictionary"},
                          Case{scene("{ pattern: charuco, size: \"19x19\", square: 5., dictionary: DICT_4X4_50 }", sets),
                               "200"},
                          Case{scene("{ pattern: chessboard, size: \"6x5\", square: -1. }", sets), "square"},
                          Case{scene("{ pattern: chessboard, size: \"6x5\", square: 39., dictionry: X }", sets), "dictionry"},
                          Case{scene(CHESSBOARD, "   glass: { windw: 1, poses: [ fixed ] }\n"), "windw"},
                          Case{replaced("exposure:", "exposur:"), "is it 'exposure'"},
                          Case{replaced("target:", "goal:"), "has no 'target'"},
                          Case{replaced("noise: 1.", "noise: -1."), "noise"},
                          Case{replaced("image_width: 640\n", ""), "image_width"},
                          Case{replaced("glass_window:", "window:"), "glass_window"},
                          Case{replaced("index: [ 1.5 ]", "index: [ 0.5 ]"), "index"},
                          Case{replaced("distance: [ 600., 700. ]", "distance: [ 100., 110. ]"), "smaller target"}})
        checkRefused(folder, c.text, c.expected, "out/truth.yml");
}

//! Of a camera above a laser, and a projector at the same place.
static std::string litScene(const std::string& laser, const std::string& sets)
{
    const std::string device = "image_width: 160, image_height: 320, camera_matrix: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: "
        "[ 300., 0., 80., 0., 300., 160., 0., 0., 1. ] }, distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, dt: d, data: "
        "[ 0., 0., 0., 0. ] }, glass_window: { normal: [ 0.3, 0.1, 0.9486832980505138 ], distance: 20., thickness: [ 8. ], index: [ 1.5 ] "
        "}, rvec: [ 0., -0.25, 0. ], tvec: [ 200., 0., 0. ]";
    return texturedScene(SHAPES, sets) + "emitters:\n   laser: { " + device + ", " + laser + " }\n   projector: { " + device
        + ", brightness: 60., fringes: { periods: [ 160., 16. ], steps: 4 } }\n";
}

static const char* const LINE = "line: 80., width: 4., brightness: 90., color: [ 0., 1., 0. ]";

TEST_CASE("refract_simulate renders the light of emitters, and says where their lines are", "[tools][simulate][emitters]")
{
    const TemporaryFolder folder;
    writeFile(folder / "rig.yml", litScene(LINE, "   dark: { window: 1, scene: 1 }\n   line: { window: 1, scene: 1, emitters: [ laser ] }\n"
        "   phases: { window: 1, scene: 1, emitters: [ projector ] }\n"));
    const ToolResult result = runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "out"));
    CAPTURE(result.err);
    REQUIRE(result.code == 0);
    const cv::Mat dark = cv::imread(folder / "out/dark1/scene.png"), line = cv::imread(folder / "out/line1/scene.png");
    const cv::FileStorage truth(folder / "out/truth.yml", cv::FileStorage::READ);
    CHECK((double)truth["emitters"]["laser"]["line"] == 80.);
    CHECK(truth["emitters"]["projector"]["line"].empty());
    for (const cv::FileNode& view : truth["scene_views"])
    {
        const std::string set = view["set"];
        CHECK(view["lines"].size() == (set == "line" ? 1u : 0u));
        if (set != "line" || (int)view["camera"] != 1)
            continue;
        const cv::Mat pixels = view["lines"][0]["pixels"].mat();
        REQUIRE(pixels.rows > 50);
        int brighter = 0;
        for (int i = 0; i < pixels.rows; i++)
        {
            const cv::Point at(cvRound(pixels.at<double>(i, 0)), cvRound(pixels.at<double>(i, 1)));
            brighter += line.at<cv::Vec3b>(at)[1] > dark.at<cv::Vec3b>(at)[1] + 10;
        }
        CHECK(brighter > 0.9*pixels.rows);
    }
    for (const char* name : {"scene_1.png", "scene_8.png", "scene_depth.tiff"})
        CHECK(std::filesystem::exists(folder / ("out/phases2/" + std::string(name))));
    CHECK_FALSE(std::filesystem::exists(folder / "out/phases2/scene_9.png"));
}

TEST_CASE("refract_simulate refuses emitters that it cannot render, with one sentence", "[tools][simulate][emitters]")
{
    const TemporaryFolder folder;
    const std::string set = "   line: { window: 1, scene: 1, emitters: [ laser ] }\n", good = litScene(LINE, set);
    const auto replaced = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.find(from), from.size(), to);
    };
    const auto laser = [&](const std::string& keys) { return litScene(keys, set); };
    struct Case { std::string text, expected; };
    for (const Case& c : {Case{replaced("[ laser ]", "[ lamp ]"), "no emitter called 'lamp'"},
                          Case{replaced("[ laser ]", "laser"), "'emitters' must be a list"},
                          Case{replaced("[ laser ]", "[ laser, projector ]"), "a set of their own"},
                          Case{laser("width: 4., brightness: 90."), "either 'line'"},
                          Case{laser("line: 80., width: 4., brightness: 90., fringes: { periods: [ 9. ] }"), "either 'line'"},
                          Case{laser("line: 80., brightness: 90."), "'width'"}, Case{laser("line: 80., width: 4."), "'brightness'"},
                          Case{laser("line: 80., width: 0., brightness: 90."), "'width'"},
                          Case{laser("line: .nan, width: 4., brightness: 90."), "'line'"},
                          Case{laser("line: 80., width: 4., brightness: 90., speckle: -1."), "'speckle'"},
                          Case{laser("line: 80., width: 4., brightness: 90., color: [ 0., 2., 0. ]"), "'color'"},
                          Case{laser("line: 80., width: 4., brightnes: 90."), "no key 'brightnes'"},
                          Case{laser("brightness: 9., fringes: { periods: [ 0. ] }"), "'periods'"},
                          Case{laser("brightness: 9., fringes: { periods: [ 9. ], steps: 2 }"), "'steps'"},
                          Case{replaced("rvec: [ 0., -0.25, 0. ], ", ""), "'rvec' is missing"},
                          Case{replaced("image_width: 160, image_height: 320", "line_width: 1"), "no key 'line_width'"}})
        checkRefused(folder, c.text, c.expected, "out");
}
