// refract_simulate as a user runs it: what it renders is where it says, for every pattern, and found again in every image.
#include "run_tool.hpp"
#include "truth_file.hpp"
#include <catch2/catch.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <opencv2/imgcodecs.hpp>

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

void write(const std::string& path, const std::string& text)
{
    std::ofstream(path, std::ios::binary) << text;
}

} // namespace

TEST_CASE("rendered targets are found where the truth says, numbered alike however they are turned", "[tools][simulate]")
{
    struct Kind { std::string target, options; int count; bool turned; double limit; };
    for (const Kind& kind : {Kind{CHESSBOARD, "--size=6x5 --square=39", 30, true, 0.05},
                             Kind{"{ pattern: acircles, size: \"4x7\", square: 25. }",
                                  "--pattern=acircles --size=4x7 --square=25", 28, false, 0.3},
                             Kind{"{ pattern: charuco, size: \"6x5\", square: 39., marker: 30. }",
                                  "--pattern=charuco --size=6x5 --square=39 --marker=30", 30, true, 0.1},
                             Kind{"{ pattern: circles, size: \"6x5\", square: 39. }",
                                  "--pattern=circles --size=6x5 --square=39", 30, false, 0.3}})
    {
        const TemporaryFolder folder;
        write(folder / "rig.yml", scene(kind.target, "   glass: { window: 1, poses: [ fixed ] }\n"));
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
            // The middle of a tilted dot's image is not the image of its middle: up to radius^2 * tilt / f = 0.3 px here.
            CHECK(std::sqrt(squares/rows.size()) < kind.limit);
        }
    }
}

TEST_CASE("a chessboard of another size than --size is told from, soon", "[tools][simulate]")
{
    const TemporaryFolder folder;
    write(folder / "rig.yml", scene("{ pattern: chessboard, size: \"9x6\", square: 22. }",
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
    write(folder / "rig.yml", scene(CHESSBOARD, sets));
    write(folder / "other.yml", scene(CHESSBOARD, sets, 2));
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
                          Case{replaced("target:", "goal:"), "has no 'target'"},
                          Case{replaced("noise: 1.", "noise: -1."), "noise"},
                          Case{replaced("image_width: 640\n", ""), "image_width"},
                          Case{replaced("glass_window:", "window:"), "glass_window"},
                          Case{replaced("index: [ 1.5 ]", "index: [ 0.5 ]"), "index"},
                          Case{replaced("distance: [ 600., 700. ]", "distance: [ 100., 110. ]"), "smaller target"}})
    {
        write(folder / "rig.yml", c.text);
        const ToolResult result = runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "out"));
        CAPTURE(c.text, result.err);
        CHECK(result.code == 1);
        CHECK(result.err.find(c.expected) != std::string::npos);
        CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
        CHECK(!std::filesystem::exists(folder / "out/truth.yml"));
    }
}
