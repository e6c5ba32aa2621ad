// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// --config: options from a file, on every tool.
#include "run_tool.hpp"
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <opencv2/core.hpp>
#include <algorithm>

namespace {

const std::string STEREO = paths::bundled() + "/stereo";

} // namespace

TEST_CASE("A settings file stands for options, and the command line goes first", "[tools][settings]")
{
    const TemporaryFolder folder;
    writeFile(folder / "run.toml", "\xEF\xBB\xBF# the bundled rig, camera 1\nsize = \"6x5\"\nsquare = 39\n\n"
        "thickness = [20]    # mm\nindex = 1.5\n"
        "direct = \"" + STEREO + "/direct1/*\"\nglass = '" + STEREO + "/glass1/*'\nfree = [\"thickness\", \"index\"]\n"
        "no-cross-validation = true\nquiet = true\nunpaired = false\nnote = [\"where=Lab 3\", \"who=A\"]\nout = \""
        + (folder / "file.yml") + "\"\n");
    const std::string common = "refract_calib --config=" + (folder / "run.toml") + " --index=1.5437";
    const ToolResult file = runTool(common);
    CAPTURE(file.err);
    REQUIRE(file.code != 1);
    CHECK(file.out.empty());
    const ToolResult line = runTool("refract_calib --size=6x5 --square=39 --thickness=20 --index=1.5437 --direct='" + STEREO
        + "/direct1/*' --glass='" + STEREO + "/glass1/*' --free=thickness,index --no-cross-validation --quiet --note=where='Lab 3' "
        "--note=who=A --out=" + (folder / "line.yml"));
    REQUIRE(line.code == file.code);
    const cv::FileStorage a(folder / "file.yml", cv::FileStorage::READ), b(folder / "line.yml", cv::FileStorage::READ);
    cv::Mat cameraMatrix[2];
    a["camera_matrix"] >> cameraMatrix[0];
    b["camera_matrix"] >> cameraMatrix[1];
    CHECK(cv::norm(cameraMatrix[0], cameraMatrix[1], cv::NORM_INF) == 0);
    CHECK((double)a["glass_window"]["index"][0] == (double)b["glass_window"]["index"][0]);
    // What goes into outputs says all that was asked for.
    const std::string command = readFile(folder / "file.yml");
    for (const std::string part : {"--size=6x5", "--thickness=20", "--free=thickness", "--free=index", "--note=where=Lab 3", "--quiet",
                                   "--index=1.5437"})
    {
        CAPTURE(part);
        CHECK(mentions(command, part));
    }
    CHECK(!mentions(command, "--index=1.5 "));
    CHECK(!mentions(command, "--unpaired"));
}

TEST_CASE("A settings file may name what has no dashes", "[tools][settings]")
{
    const TemporaryFolder folder;
    writeFile(folder / "run.toml", "calib.yml = \"" + STEREO + "/truth.yml\"\nIMAGE = \"" + STEREO + "/measure1/z600_[12].jpg\"\n"
                                   "depth = 600\nout-dir = \"" + (folder / "out") + "\"\n");
    const ToolResult result = runTool("refract_undistort --config=" + (folder / "run.toml"));
    CAPTURE(result.err);
    CHECK(result.code == 0);
    CHECK(mentions(result.out, "2 images"));
}

TEST_CASE("A settings file that does not fit is refused with one sentence, and never overwritten", "[tools][settings]")
{
    const TemporaryFolder folder;
    const std::string calib = STEREO + "/truth.yml", left = STEREO + "/measure1/z600_1.jpg", right = STEREO + "/measure2/z600_1.jpg";
    const std::string rig = STEREO + "/rig.yml", file = folder / "run.yml";
    const std::string target = " --size=6x5 --square=39";
    const std::string tools[] = {"refract_accept", "refract_board", "refract_bundle", "refract_calib", "refract_check", "refract_epilines",
                                 "refract_export", "refract_laser", "refract_measure", "refract_simulate", "refract_stereo",
                                 "refract_undistort"};
    const struct { std::string text, expected; } bad[] = {
        {"squares = 39\n", "no setting 'squares'"}, {"[camera]\nsize = 5\n", "begins a section"},
        {"quiet = true\nquiet = false\n", "'quiet' is set twice"},
        {"quiet = true\r\n'quiet' =false\r\n", "'quiet' is set twice"}, {std::string(1000000, 'x') + "\n", "no setting"},
        {"config = \"other.toml\"\n", "'config' belongs on the command line"}, {"\x01\x02\x03\x04\n\xff\xfe\xfd", "no setting"}};
    for (const std::string& tool : tools)
        for (const auto& b : bad)
        {
            writeFile(file, b.text);
            const ToolResult result = runTool(tool + " --config=" + file);
            CAPTURE(tool, b.text, result.out, result.err);
            CHECK(result.code == 1);
            CHECK(mentions(result.err, b.expected));
            CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
        }
    for (const std::string name : {"none.toml", ""})
    {
        const ToolResult none = runTool("refract_check --config=" + (folder/name));
        CAPTURE(name, none.err);
        CHECK(none.code == 1);
        CHECK(mentions(none.err, "--config=" + folder/name + ": there is no such file"));
    }
    writeFile(file, "size = \"6by5\"\n");
    const ToolResult value = runTool("refract_board --square=20 --out=" + (folder / "b.pdf") + " --config=" + file);
    CHECK(value.code == 1);
    CHECK(mentions(value.err, "--size=6by5"));

    // An extension that all of them write.
    const std::string quiet = "quiet = true\n";
    writeFile(folder / "run.pdf", quiet);
    writeFile(folder / "run.png", quiet);
    std::filesystem::create_directory(folder / "d");
    for (const std::string name : {"truth.yml", "cameras.txt", "z600_1.jpg", "cloud.ply"})
        writeFile(folder/("d/" + name), quiet);
    writeFile(file, quiet);
    const std::string d = folder / "d";
    const std::string commands[] = {
        "refract_accept " + calib + " --points=" + left + " --lengths=" + left + " --max-error=1 --summary=" + file + " --config=" + file,
        "refract_board" + target + " --out=" + (folder / "run.pdf") + " --config=" + (folder / "run.pdf"),
        "refract_calib" + target + " --thickness=20 --index=1.5 --glass=" + left + " --camera=" + calib + " --out=" + file
            + " --config=" + file,
        "refract_check " + calib + target + " --glass=" + left + " --summary=" + file + " --config=" + file,
        "refract_epilines " + calib + " " + left + " " + right + target + " --out=" + (folder / "run.png") + " --config="
            + (folder / "run.png"),
        "refract_export " + calib + " --to=opencv --depth=400,800 --out=" + file + " --config=" + file,
        "refract_export " + calib + " --to=colmap --depth=400,800 --out-dir=" + d + " --config=" + d + "/cameras.txt",
        "refract_laser " + calib + " " + left + target + " --sheet-out=" + file + " --config=" + file,
        "refract_measure " + calib + " " + left + " " + right + target + " --pixel-sigma=0.01 --out=" + file + " --config=" + file,
        "refract_simulate " + rig + " --out-dir=" + d + " --config=" + d + "/truth.yml",
        "refract_stereo " + calib + " " + left + " " + right + " --depth=400,900 --out=" + d + "/cloud.ply --config=" + d + "/cloud.ply",
        "refract_undistort " + calib + " " + left + " --depth=600 --out-dir=" + d + " --config=" + d + "/z600_1.jpg"};
    for (const std::string& command : commands)
    {
        const ToolResult result = runTool(command);
        CAPTURE(command, result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, "overwritten"));
        CHECK(readFile(command.substr(command.rfind('=') + 1)) == quiet);
    }
}
