// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What the tools write never takes the place of what they read.
#include "run_tool.hpp"
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <fcntl.h>
#include <map>
#include <regex>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

const std::string STEREO = paths::bundled() + "/stereo";
const std::string TARGET = " --size=6x5 --square=39";

//! A folder with a calibration and images that may be spoiled.
struct Inputs
{
    TemporaryFolder folder;
    std::string calib = folder / "calib.yml", left = folder / "left.jpg", right = folder / "right.jpg";

    Inputs()
    {
        std::filesystem::copy_file(STEREO + "/truth.yml", calib);
        std::filesystem::copy_file(STEREO + "/measure1/z600_1.jpg", left);
        std::filesystem::copy_file(STEREO + "/measure2/z600_1.jpg", right);
        std::filesystem::create_symlink(left, folder / "link.jpg");
        std::filesystem::create_hard_link(calib, folder / "hard.yml");
        std::filesystem::create_directory(folder / "sub");
    }

    //! Contents of all files, by name.
    std::map<std::string, std::string> contents() const
    {
        std::map<std::string, std::string> all;
        for (const auto& entry : std::filesystem::directory_iterator(folder / ""))
            if (entry.is_regular_file())
                all[entry.path().string()] = readFile(entry.path().string());
        return all;
    }
};

} // namespace

TEST_CASE("no tool overwrites what it reads, or writes one file twice", "[tools][outputs]")
{
    const Inputs in;
    const TemporaryFolder& f = in.folder;
    const std::string images = " " + in.left + " " + in.right + TARGET;
    const std::string measure = "refract_measure " + in.calib + images + " --pixel-sigma=0.014 --out=";
    const std::string epilines = "refract_epilines " + in.calib + images + " --out=";
    const std::string calib = "refract_calib" + TARGET + " --thickness=20 --index=1.5 --camera=" + in.calib + " --glass='"
                              + (f / "*.jpg") + "' --out=";
    const std::string check = "refract_check " + in.calib + TARGET + " --pixel-sigma=0.014 --glass=" + in.left + " --summary=";
    std::ofstream(f / "truth.yml") << readFile(STEREO + "/rig.yml");
    std::ofstream(f / "points.txt") << "640 500\n";

    const struct { std::string command, expected; } cases[] = {
        {measure + in.calib, "overwritten"},
        {measure + in.left, "overwritten"},
        {measure + (f / "sub/../right.jpg"), "overwritten"},
        {measure + (f / "link.jpg"), "overwritten"},
        {measure + (f / "hard.yml"), "overwritten"},
        {measure + (f / "p.csv") + " --compare-with=" + (f / "p.csv"), "p.csv"},
        {measure + (f / "no/p.csv"), "does not exist"},
        {measure + (f / "sub"), "folder"},
        {epilines + in.left, "overwritten"},
        {epilines + (f / "picture"), "extension"},
        {epilines + (f / "picture.txt"), "extension"},
        {"refract_epilines " + in.calib + " " + in.left + " " + in.right + " --points=" + (f / "points.txt") + " --out="
            + (f / "points.txt"), "extension"},
        {"refract_undistort " + in.calib + " " + in.left + " --depth=600 --out-dir=" + (f / "sub/.."), "overwritten"},
        {"refract_undistort " + in.calib + " '" + in.left + "' --depth=600 --out-dir=" + (f / ""), "overwritten"},
        {"refract_simulate " + (f / "truth.yml") + " --out-dir=" + (f / ""), "overwritten"},
        {check + in.calib, "overwritten"},
        {check + in.left, "overwritten"},
        {calib + in.calib, "overwritten"},
        {calib + in.left, "extension"},
        {calib + (f / "new.txt"), ".yml"},
        {calib + (f / "new"), ".yml"},
        {calib + (f / "new.yml") + " --report=" + in.left, "overwritten"},
        {calib + (f / "new.yml") + " --summary=" + in.right, "overwritten"},
        {calib + (f / "new.yml") + " --summary=" + (f / "./new.yml"), "--out and --summary"},
        {calib + (f / "new.yml") + " --summary=" + (f / "x") + " --report=" + (f / "sub/../x"), "--summary and --report"},
        {calib + (f / "new.yml") + " --pinhole-out=" + (f / "new.yml"), "--out and --pinhole-out"},
        {calib + (f / "new.yml") + " --pinhole-out=" + (f / "pinhole.csv"), "--pinhole-out"},
    };
    const auto before = in.contents();
    for (const auto& c : cases)
    {
        const ToolResult result = runTool(c.command);
        INFO(c.command << "\n" << result.err);
        CHECK(result.code == 1);
        CHECK(result.err.find(c.expected) != std::string::npos);
        CHECK(in.contents() == before);
    }
}

TEST_CASE("Links stay links, pipes stay pipes, and what is read-only stays", "[tools][outputs]")
{
    const Inputs in;
    const TemporaryFolder& f = in.folder;
    const std::string measure = "refract_measure " + in.calib + " " + in.left + " " + in.right + TARGET
                                + " --pixel-sigma=0.014 --quiet --out=";
    const std::string calib = "refract_calib" + TARGET + " --thickness=20 --index=1.5437 --direct='" + STEREO
        + "/direct1/*' --glass='" + STEREO + "/glass1/*' --no-cross-validation --quiet --out=";
    REQUIRE(runTool(measure + (f / "points.csv")).code == 0);
    const std::string points = readFile(f / "points.csv");
    REQUIRE(points.size() > 1000);

    std::ofstream(f / "sub/old.csv") << "old";
    std::filesystem::permissions(f / "sub/old.csv", std::filesystem::perms(0600));
    std::filesystem::create_symlink("sub/old.csv", f / "link.csv");
    std::filesystem::create_symlink("sub/new.csv", f / "dangling.csv");
    for (const std::string name : {"link.csv", "dangling.csv"})
    {
        const ToolResult result = runTool(measure + (f/name));
        INFO(name << result.err);
        CHECK(result.code == 0);
        CHECK(std::filesystem::is_symlink(f/name));
        CHECK(readFile(f/name) == points);
    }
    CHECK(readFile(f / "sub/old.csv") == points);
    CHECK(readFile(f / "sub/new.csv") == points);
    CHECK(std::filesystem::status(f / "sub/old.csv").permissions() == std::filesystem::perms(0600));
    std::filesystem::create_symlink("round.csv", f / "round.csv");
    CHECK(runTool(measure + (f / "round.csv")).code == 1);

    REQUIRE(mkfifo((f / "pipe").c_str(), 0600) == 0);
    const int reader = open((f / "pipe").c_str(), O_RDONLY | O_NONBLOCK);     // the pipe holds 64 kB, a table far less
    REQUIRE(reader >= 0);
    const auto readPipe = [reader] {
        std::string bytes(1 << 16, 0);
        bytes.resize(std::max<ssize_t>(0, read(reader, &bytes[0], bytes.size())));
        return bytes;
    };
    const ToolResult piped = runTool(measure + (f / "pipe"));
    INFO(piped.err);
    CHECK(piped.code == 0);
    CHECK(std::filesystem::is_fifo(f / "pipe"));
    CHECK(readPipe() == points);
    const ToolResult both = runTool(calib + (f / "pipe") + " --summary=" + (f / "pipe"));
    INFO(both.err);
    CHECK(both.code != 1);
    CHECK(std::filesystem::is_fifo(f / "pipe"));
    CHECK(readPipe().find("%YAML") != std::string::npos);
    close(reader);

    for (const char* quiet : {"", " --quiet"})
    {
        const ToolResult printed = runTool(std::regex_replace(measure, std::regex(" --quiet"), quiet) + "/dev/stdout");
        INFO(printed.out << printed.err);
        CHECK(printed.code == 0);
        CHECK(printed.out.compare(0, points.size(), points) == 0);
    }

    std::ofstream(f / "kept.csv") << "kept";
    std::filesystem::permissions(f / "kept.csv", std::filesystem::perms(0444));
    const ToolResult refused = runTool(measure + (f / "kept.csv"));
    INFO(refused.err);
    CHECK(refused.code == 1);
    CHECK(refused.err.find("is read-only") != std::string::npos);
    CHECK(readFile(f / "kept.csv") == "kept");
}

TEST_CASE("A pipe that nobody reads any more is no error of a file", "[tools][outputs]")
{
    const Inputs in;
    // `true` has ended long before there is a point to write.
    const ToolResult result = runTool("refract_measure " + in.calib + " " + in.left + " " + in.right + TARGET
        + " --pixel-sigma=0.014 --quiet --out=/dev/stdout 2>" + (in.folder / "said") + " | true");
    CAPTURE(readFile(in.folder / "said"));
    CHECK(!mentions(readFile(in.folder / "said"), "cannot"));
}

TEST_CASE("A disk that is full is told, and what was there stays", "[tools][outputs]")
{
    const Inputs in;
    const TemporaryFolder& f = in.folder;
    const std::string full = "trap '' XFSZ; ulimit -f 2;";          // a file ends at some kB
    const std::string commands[] = {
        "refract_calib" + TARGET + " --thickness=20 --index=1.5437 --direct='" + STEREO + "/direct1/*' --glass='" + STEREO
            + "/glass1/*' --no-cross-validation --quiet --out=",
        "refract_export " + in.calib + " --to=opencv --depth=400,800 --out=",
        "refract_epilines " + in.calib + " " + in.left + " " + in.right + TARGET + " --quiet --out=",
        "refract_board" + TARGET + " --out="};
    for (const std::string& command : commands)
    {
        const std::string out = f/(mentions(command, "board") ? "old.pdf" : mentions(command, "epilines") ? "old.png" : "old.yml");
        std::ofstream(out) << "old";
        const ToolResult result = runTool(command + out, full);
        CAPTURE(command, result.out, result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, "is the disk full?"));
        CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);     // the libraries' own words are not for users
        CHECK(readFile(out) == "old");
    }
}

TEST_CASE("What a full disk does not take is kept elsewhere, and it is said where", "[tools][outputs]")
{
    const Inputs in;
    const TemporaryFolder& f = in.folder;
    for (const char* folder : {"small", "elsewhere"})
        std::filesystem::create_directory(f/folder);
    const std::string enter = "unshare -rm sh -c 'mount -t tmpfs -o size=4k none " + f / "small" + " && ";     // a page
    if (std::system((enter + "true' 2>/dev/null").c_str()) != 0)
    {
        WARN("SKIPPED: no file system of one page can be made here");
        return;
    }
    const std::string measure = paths::programs() + "/refract_measure " + in.calib + " " + in.left + " " + in.right + TARGET
        + " --pixel-sigma=0.014 --quiet --out=" + f / "small/points.csv";
    CHECK(std::system((enter + "TMPDIR=" + f / "elsewhere" + " " + measure + "' 2>" + f / "said").c_str()) != 0);
    const std::string said = readFile(f / "said");
    CAPTURE(said);
    REQUIRE(mentions(said, "is the disk full? It is kept as '" + f / "elsewhere/points-"));
    const std::string kept = said.substr(said.find("kept as '") + 9);
    const std::string text = readFile(kept.substr(0, kept.find('\'')));
    CHECK(std::count(text.begin(), text.end(), '\n') == 31);
}

TEST_CASE("The calibration is written before what can be made of it anew", "[tools][outputs]")
{
    const TemporaryFolder f;
    const std::string wand = paths::bundled() + "/wand/";
    const ToolResult result = runTool("refract_bundle " + wand + "start.yml --points=" + wand + "matches.csv --lengths=" + wand
        + "lengths.csv --quiet --points-out=/dev/full --out=" + (f / "calib.yml"));
    CAPTURE(result.err);
    CHECK(result.code == 1);
    CHECK(mentions(result.err, "/dev/full"));
    CHECK(cv::FileStorage(f / "calib.yml", cv::FileStorage::READ).isOpened());
}

TEST_CASE("A table that cannot be printed is a failure", "[tools][outputs]")
{
    const Inputs in;
    const std::string said = in.folder / "said";
    const ToolResult result = runTool("refract_board" + TARGET + " --out=" + (in.folder / "b.pdf") + " >/dev/full 2>" + said + "; exit $?");
    CHECK(result.code == 1);
    CHECK(mentions(readFile(said), "is the disk full?"));
}

TEST_CASE("JSON is what others read too", "[tools][outputs]")
{
    const Inputs in;
    for (const std::string& command : {"refract_calib" + TARGET + " --thickness=20 --index=1.5437 --direct='" + STEREO
                                          + "/direct1/*' --glass='" + STEREO + "/glass1/*' --note=by='O\"Neill' "
                                          "--no-cross-validation --quiet --out=",
                                      "refract_export " + in.calib + " --to=opencv --depth=400,800 --out="})
    {
        const std::string out = in.folder / "c.json";
        const ToolResult result = runTool(command + out);
        CAPTURE(command, result.err);
        CHECK(result.code != 1);
        CHECK(nlohmann::json::accept(readFile(out)));
        CHECK(cv::FileStorage(out, cv::FileStorage::READ).isOpened());
    }
}

TEST_CASE("Of two runs with one output the second is refused before any work", "[tools][outputs]")
{
    const Inputs in;
    const std::string out = in.folder / "points.csv", lock = in.folder / ".points.csv.lock";
    const std::string measure = "refract_measure " + in.calib + " " + in.left + " " + in.right + TARGET + " --pixel-sigma=0.014 --out=";
    const int other = open(lock.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
    REQUIRE(flock(other, LOCK_EX | LOCK_NB) == 0);
    std::filesystem::create_symlink(out, in.folder / "points_link.csv");
    for (const std::string& name : {out, in.folder / "./points.csv", in.folder / "points_link.csv"})
    {
        const ToolResult refused = runTool(measure + name);
        CAPTURE(refused.err);
        CHECK(refused.code == 1);
        CHECK(mentions(refused.err, "--out: another run is about to write '" + name + "'"));
        CHECK_FALSE(std::filesystem::exists(out));
    }
    close(other);                               // ended without a word: its file stays, and keeps nobody out
    const ToolResult next = runTool(measure + out);
    CAPTURE(next.err);
    CHECK(next.code != 1);
    CHECK(std::filesystem::exists(out));
    CHECK_FALSE(std::filesystem::exists(lock));
}
